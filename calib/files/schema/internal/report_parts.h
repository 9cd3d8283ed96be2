#pragma once

// The pieces of a report, to and from its message. JSON knows no NaN: a number
// that is not finite is left out, and what is not there is read as NaN.

#include <cmath>
#include <optional>

#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/calibration.h"

namespace rgbdt::text {

template <typename Message>
void SetFinite(const std::optional<double>& value, void (Message::*set)(double), Message* out) {
  if (value && std::isfinite(*value)) (out->*set)(*value);
}

void FromPoseError(const PoseError& error, proto::PoseError* out);
PoseError ToPoseError(const proto::PoseError& error);

void FromEstimate(const Estimate& estimate, proto::Estimate* out);
Estimate ToEstimate(const proto::Estimate& estimate);

void FromTiming(const CameraTiming& timing, proto::CameraTiming* out);
/// Throws InputError for numbers that no clock and no shutter has.
CameraTiming ToTiming(const proto::CameraTiming& timing, const Place& place);
void FromRangeErrors(const RangeErrors& errors, proto::RangeErrors* out);
/// Throws InputError for rings and intensities that do not rise, and numbers that are not finite.
RangeErrors ToRangeErrors(const proto::RangeErrors& errors, const Place& place);

void FromTrainHeldout(const TrainHeldout& figure, proto::TrainHeldout* out);
TrainHeldout ToTrainHeldout(const proto::TrainHeldout& figure);

/// The uncertainty of a camera's pose: edge_rms_whitened, _mm, plane_rms_mm, sigma, nuisance,
/// folds, halves, edges_planes and scene.
void FromUncertainty(const CameraReport& camera, proto::CameraReport* out);
/// Throws InputError where a list of numbers has another length than it should.
void ToUncertainty(const proto::CameraReport& message, const Place& place, CameraReport* camera);

/// The report's closure and next view; one whose poses are not finite is left out.
void FromRigWide(const Report& report, proto::Report* out);
/// Throws InputError where a pose is none. `where` is the file.
void ToRigWide(const proto::Report& message, const std::string& where, Report* report);

}  // namespace rgbdt::text
