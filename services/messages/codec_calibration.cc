#include <cmath>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, solved_lens_t>& wire,
            StructOf<Copy, SolvedLens>& solved) {
  copy(wire.model, solved.lens.model);
  copy(wire.fx, solved.lens.fx);
  copy(wire.fy, solved.lens.fy);
  copy(wire.cx, solved.lens.cx);
  copy(wire.cy, solved.lens.cy);
  copy(wire.distortion, solved.lens.distortion);
  copy(wire.covariance, solved.covariance);
}

solved_lens_t ToWire(const SolvedLens& lens) { return FieldsToWire<solved_lens_t>(lens); }

void Check(const solved_lens_t& wire) {
  CheckRange("lens.model", wire.model, solved_lens_t::PINHOLE, solved_lens_t::FISHEYE);
  const double centre[] = {wire.cx, wire.cy};
  for (const double focal : {wire.fx, wire.fy}) {
    CheckFinite("lens focal length", focal);
    if (!(focal > 0)) Fail("lens focal length", focal, "more than 0");
  }
  CheckFinite("lens centre", centre, 2);
  CheckFinite("lens.distortion", wire.distortion, 8);
  CheckFinite("lens.covariance", wire.covariance[0], std::size_t{kLensNumbers} * kPoseAndLens);
  double own[kLensNumbers][kLensNumbers];
  for (int row = 0; row < kLensNumbers; ++row) {
    std::copy(wire.covariance[row] + 6, wire.covariance[row] + kPoseAndLens, own[row]);
  }
  CheckCovariance("lens.covariance", own[0], kLensNumbers);
}

SolvedLens FromWire(const solved_lens_t& wire) { return FieldsFromWire<SolvedLens>(wire); }

range_errors_t ToWire(const RangeErrors& errors) {
  range_errors_t wire{};
  wire.offset_m = errors.offset_m.value;
  wire.offset_sigma_m = errors.offset_m.sigma;
  wire.beams_meet_m = errors.beams_meet_m.value;
  wire.beams_meet_sigma_m = errors.beams_meet_m.sigma;
  wire.num_rings = CountOf(errors.rings.size(), "num_rings");
  for (const auto& [ring, offset_m] : errors.rings) {
    wire.ring.push_back(ring);
    wire.ring_offset_m.push_back(offset_m.value);
    wire.ring_offset_sigma_m.push_back(offset_m.sigma);
  }
  wire.num_intensities = CountOf(errors.intensities.size(), "num_intensities");
  for (const auto& [log2_intensity, offset_m] : errors.intensities) {
    wire.log2_intensity.push_back(log2_intensity);
    wire.intensity_offset_m.push_back(offset_m.value);
    wire.intensity_offset_sigma_m.push_back(offset_m.sigma);
  }
  return wire;
}

void Check(const range_errors_t& wire) {
  CheckFinite("range_errors.offset_m", wire.offset_m);
  CheckNotNegative("range_errors.offset_sigma_m", wire.offset_sigma_m);
  CheckFinite("range_errors.beams_meet_m", wire.beams_meet_m);
  CheckNotNegative("range_errors.beams_meet_sigma_m", wire.beams_meet_sigma_m);
  for (std::size_t i = 0; i < wire.ring.size(); ++i) {
    const int least = i == 0 ? 0 : wire.ring[i - 1] + 1;
    CheckRange(At("range_errors.ring", i), wire.ring[i], least, kMostLasers - 1);
    CheckFinite(At("range_errors.ring_offset_m", i), wire.ring_offset_m[i]);
    CheckNotNegative(At("range_errors.ring_offset_sigma_m", i), wire.ring_offset_sigma_m[i]);
  }
  for (std::size_t i = 0; i < wire.log2_intensity.size(); ++i) {
    const double log2 = wire.log2_intensity[i];
    const bool follows = i == 0 || log2 == wire.log2_intensity[i - 1] + 1;
    if (!(log2 >= kLeastLog2Intensity && log2 <= 0 && follows)) {
      Fail(At("range_errors.log2_intensity", i), log2, "-16 to 0, each one more than the last");
    }
    CheckFinite(At("range_errors.intensity_offset_m", i), wire.intensity_offset_m[i]);
    CheckNotNegative(At("range_errors.intensity_offset_sigma_m", i),
                     wire.intensity_offset_sigma_m[i]);
  }
}

RangeErrors FromWire(const range_errors_t& wire) {
  RangeErrors errors;
  errors.offset_m = {wire.offset_m, wire.offset_sigma_m};
  errors.beams_meet_m = {wire.beams_meet_m, wire.beams_meet_sigma_m};
  for (std::size_t i = 0; i < wire.ring.size(); ++i) {
    errors.rings.push_back({wire.ring[i], {wire.ring_offset_m[i], wire.ring_offset_sigma_m[i]}});
  }
  for (std::size_t i = 0; i < wire.log2_intensity.size(); ++i) {
    errors.intensities.push_back(
        {wire.log2_intensity[i], {wire.intensity_offset_m[i], wire.intensity_offset_sigma_m[i]}});
  }
  return errors;
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, camera_timing_t>& wire,
            StructOf<Copy, CameraTiming>& timing) {
  copy(wire.time_offset_s, timing.time_offset_s.value);
  copy(wire.time_offset_sigma_s, timing.time_offset_s.sigma);
  copy(wire.rolling_s, timing.rolling_s.value);
  copy(wire.rolling_sigma_s, timing.rolling_s.sigma);
}

camera_timing_t ToWire(const CameraTiming& timing) { return FieldsToWire<camera_timing_t>(timing); }

void Check(const camera_timing_t& wire) {
  // A second is no read-out.
  if (!(std::abs(wire.time_offset_s) <= kMaxTimeOffsetS)) {
    Fail("timing.time_offset_s", wire.time_offset_s, "-60 to 60");
  }
  if (!(std::abs(wire.rolling_s) <= 1)) Fail("timing.rolling_s", wire.rolling_s, "-1 to 1");
  CheckNotNegative("timing.time_offset_sigma_s", wire.time_offset_sigma_s);
  CheckNotNegative("timing.rolling_sigma_s", wire.rolling_sigma_s);
}

CameraTiming FromWire(const camera_timing_t& wire) { return FieldsFromWire<CameraTiming>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, calibration_t>& wire,
            StructOf<Copy, CalibrationMessage>& message) {
  auto& calibration = message.calibration;
  copy(wire.utime, message.utime);
  copy(wire.seq, message.seq);
  copy(wire.camera, calibration.camera);
  copy(wire.rig_hash, message.rig_hash);
  copy(wire.method, message.method);
  copy(wire.status, calibration.status);
  copy(wire.detail, calibration.detail);
  copy.Pose(wire.quaternion_wxyz, wire.translation_m, calibration.camera_from_lidar);
  copy.Optional(wire.has_covariance, wire.covariance, calibration.covariance);
  copy.Optional(wire.has_lens, wire.lens, calibration.lens);
  copy.Optional(wire.has_range_errors, wire.range_errors, calibration.range_errors);
  copy.Optional(wire.has_timing, wire.timing, calibration.timing);
}

calibration_t ToWire(const CalibrationMessage& message) {
  return FieldsToWire<calibration_t>(message);
}

void Check(const calibration_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckCameraName("camera", wire.camera);
  CheckName("rig_hash", wire.rig_hash, true);
  CheckName("method", wire.method, true);
  CheckRange("status", wire.status, calibration_t::NOT_SOLVED, calibration_t::CONTRADICTED);
  CheckText("detail", wire.detail);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  if (wire.has_covariance != 0) CheckCovariance("covariance", wire.covariance[0], 6);
  if (wire.has_lens != 0) Check(wire.lens);
  if (wire.has_range_errors != 0) Check(wire.range_errors);
  if (wire.has_timing != 0) Check(wire.timing);
}

CalibrationMessage FromWire(const calibration_t& wire) {
  return FieldsFromWire<CalibrationMessage>(wire);
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, mount_check_t>& wire,
            StructOf<Copy, MountCheck>& check) {
  copy(wire.utime, check.utime);
  copy(wire.seq, check.seq);
  copy(wire.camera, check.camera);
  copy(wire.calibration_utime, check.calibration_utime);
  copy(wire.sweeps, check.sweeps);
  copy(wire.mount_state, check.state);
  copy.Optional(wire.has_holds, wire.holds, check.holds);
  copy.Pose(wire.quaternion_wxyz, wire.translation_m, check.camera_from_lidar);
  copy(wire.moved, check.moved);
  copy(wire.covariance, check.covariance);
  copy(wire.told, check.told);
  copy(wire.edges, check.edges);
  copy(wire.shown, check.shown);
  copy(wire.told_where, check.where);
  copy(wire.text, check.text);
}

mount_check_t ToWire(const MountCheck& check) { return FieldsToWire<mount_check_t>(check); }

void Check(const mount_check_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckCameraName("camera", wire.camera);
  CheckUtimeOrZero("calibration_utime", wire.calibration_utime);
  CheckRange("sweeps", wire.sweeps, 0, kMaxLines);
  CheckRange("mount_state", wire.mount_state, mount_check_t::CANNOT_TELL, mount_check_t::LOST);
  if (wire.has_holds != 0) CheckShare("holds", wire.holds);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  CheckFinite("moved", wire.moved, 6);
  CheckCovariance("covariance", wire.covariance[0], 6);
  for (const double told : wire.told) CheckShare("told", told);
  CheckNotNegative("edges", wire.edges);
  CheckShare("shown", wire.shown);
  for (const double where : wire.told_where) CheckShare("told_where", where);
  CheckText("text", wire.text);
}

MountCheck FromWire(const mount_check_t& wire) { return FieldsFromWire<MountCheck>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, pose_t>& wire, StructOf<Copy, StampedPose>& pose) {
  copy(wire.utime, pose.utime);
  copy(wire.seq, pose.seq);
  copy(wire.source, pose.source);
  copy.Pose(wire.quaternion_wxyz, wire.translation_m, pose.map_from_lidar);
}

pose_t ToWire(const StampedPose& pose) { return FieldsToWire<pose_t>(pose); }

void Check(const pose_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckName("source", wire.source, true);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
}

StampedPose FromWire(const pose_t& wire) { return FieldsFromWire<StampedPose>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, odometry_t>& wire,
            StructOf<Copy, SweepOdometry>& odometry) {
  copy(wire.utime, odometry.utime);
  copy(wire.seq, odometry.seq);
  copy(wire.placed, odometry.placed);
  copy(wire.begun_anew, odometry.begun_anew);
  copy.Pose(wire.quaternion_wxyz, wire.translation_m, odometry.map_from_lidar);
  copy(wire.velocity, odometry.velocity);
  copy(wire.covariance, odometry.covariance);
  copy.List("untold", wire.num_untold, wire.untold, odometry.untold);
  copy(wire.residual_m, odometry.residual_m);
  copy(wire.text, odometry.text);
}

odometry_t ToWire(const SweepOdometry& odometry) { return FieldsToWire<odometry_t>(odometry); }

void Check(const odometry_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  CheckFinite("velocity", wire.velocity, 6);
  CheckCovariance("covariance", wire.covariance[0], 6);
  for (const std::string& direction : wire.untold) CheckText("untold", direction);
  CheckNotNegative("residual_m", wire.residual_m);
  CheckText("text", wire.text);
}

SweepOdometry FromWire(const odometry_t& wire) { return FieldsFromWire<SweepOdometry>(wire); }

}  // namespace rgbdt
