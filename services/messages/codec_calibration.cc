#include "services/messages/check.h"
#include "services/messages/internal/codec_geometry.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {

calibration_t ToWire(const CalibrationMessage& message) {
  const CameraCalibration& calibration = message.calibration;
  calibration_t wire{};
  wire.utime = message.utime;
  wire.seq = message.seq;
  wire.camera = calibration.camera;
  wire.rig_hash = message.rig_hash;
  wire.method = message.method;
  wire.status = static_cast<std::int8_t>(calibration.status);
  wire.detail = calibration.detail;
  RigidToWire(calibration.camera_from_lidar, wire.quaternion_wxyz, wire.translation_m);
  wire.has_covariance = static_cast<std::int8_t>(calibration.covariance.has_value());
  if (calibration.covariance) MatrixToWire(*calibration.covariance, wire.covariance);
  return wire;
}

void Check(const calibration_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
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
  CalibrationMessage message;
  message.utime = wire.utime;
  message.seq = wire.seq;
  message.rig_hash = wire.rig_hash;
  message.method = wire.method;
  CameraCalibration& calibration = message.calibration;
  calibration.camera = wire.camera;
  calibration.status = static_cast<SolveStatus>(wire.status);
  calibration.detail = wire.detail;
  calibration.camera_from_lidar = RigidFromWire(wire.quaternion_wxyz, wire.translation_m);
  if (wire.has_covariance != 0) calibration.covariance = MatrixFromWire(wire.covariance);
  return message;
}

pose_t ToWire(const StampedPose& pose) {
  pose_t wire;
  wire.utime = pose.utime;
  wire.seq = pose.seq;
  wire.source = pose.source;
  RigidToWire(pose.map_from_lidar, wire.quaternion_wxyz, wire.translation_m);
  return wire;
}

void Check(const pose_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckName("source", wire.source, true);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
}

StampedPose FromWire(const pose_t& wire) {
  StampedPose pose;
  pose.utime = wire.utime;
  pose.seq = wire.seq;
  pose.source = wire.source;
  pose.map_from_lidar = RigidFromWire(wire.quaternion_wxyz, wire.translation_m);
  return pose;
}

}  // namespace rgbdt
