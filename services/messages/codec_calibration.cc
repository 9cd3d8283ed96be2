#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

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
