#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/comparison.h"

namespace rgbdt {

/// Of the held-out crossings' RMS in their sigmas: outside of these the sigmas are not as stated.
inline constexpr double kLeastWhitened = 0.7, kMostWhitened = 1.4;

/// How far away the points are whose projection uncertainty a calibration is judged by.
inline constexpr double kJudgedAtM = 5;

/// That uncertainty; null: unknown.
const ColouringSigma* JudgedColouring(const CameraReport& camera);

/// Judges by what the report itself holds, and gives the rule with the figure.
///
///  - do not use: no pose, or one short of the optimum, or that the views do not determine;
///    sessions that contradict each other; views that scatter ten times as much as they state;
///    held-out views that lie elsewhere; something was given wrong (Cause) that moves the pose by
///    more than 4 of its sigmas.
///  - doubtful: something was given wrong that moves the pose by more than 1 sigma, or nobody knows
///    how far; more than a quarter of the views were rejected; views scatter far more than they
///    state; beams and planes are missed by more than LIDARs leave; halves or held-out views
///    contradict the stated uncertainty, edges and planes each other by far; a projection
///    uncertainty of more than 100 pixels 5 m away.
///  - usable: it could be more exact, or better checked: few views, nothing held out, a
///    projection uncertainty of more than a pixel 5 m away, views that scatter more than stated,
///    which the enlarged sigma makes good for; a method that states no uncertainty.
///
/// `next_view` is the report's.
Verdict Judge(const CameraReport& camera, const std::optional<NextView>& next_view = std::nullopt);

/// Where to hold the board next, of a report to which more views are of help: nullptr where a
/// camera is not to be used, and something else has to be corrected first.
const NextView* NextViewOf(const Report& report);

/// The worst of its cameras'; kNone of none.
Grade GradeOf(const Report& report);

/// The report with each camera's verdict, as files have it.
[[nodiscard]] Report WithVerdicts(Report report);

/// The calibration that the report of this rig holds: for its sensors, and with the status
/// `contradicted` where a pose was found that is not to be used.
Calibration JudgedCalibration(const Report& report, const Rig& rig);

}  // namespace rgbdt
