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
}

calibration_t ToWire(const CalibrationMessage& message) {
  return FieldsToWire<calibration_t>(message);
}

void Check(const calibration_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckCameraName("camera", wire.camera);
  CheckName("rig_hash", wire.rig_hash, true);
  CheckName("method", wire.method, true);
  CheckRange("status", wire.status, calibration_t::NOT_SOLVED, calibration_t::CONVERGED);
  CheckText("detail", wire.detail);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  if (wire.has_covariance != 0) CheckCovariance("covariance", wire.covariance[0], 6);
  if (wire.has_lens != 0) Check(wire.lens);
}

CalibrationMessage FromWire(const calibration_t& wire) {
  return FieldsFromWire<CalibrationMessage>(wire);
}

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

}  // namespace rgbdt
