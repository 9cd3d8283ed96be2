#include <cmath>

#include "services/bus/check.h"
#include "services/bus/codec_types.h"

namespace rgbdt {
namespace {

void CovarianceToWire(const Matrix6d& covariance, double wire[6][6]) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) wire[row][column] = covariance(row, column);
  }
}

// Symmetric, and no variance below zero.
void CheckCovariance(const double wire[6][6]) {
  CheckFinite("covariance", wire[0], 36);
  for (int row = 0; row < 6; ++row) {
    if (wire[row][row] < 0) Fail("covariance of one", wire[row][row], "0 or more");
    for (int column = 0; column < row; ++column) {
      const double scale = std::sqrt(wire[row][row] * wire[column][column]);
      const double difference = std::abs(wire[row][column] - wire[column][row]);
      if (difference > 1e-6 * scale) {
        Fail("asymmetry of covariance", difference, "a symmetric matrix");
      }
    }
  }
}

Matrix6d CovarianceFromWire(const double wire[6][6]) {
  Matrix6d covariance;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) covariance(row, column) = wire[row][column];
  }
  return covariance;
}

void RigidToWire(const Rigid3& rigid, double quaternion_wxyz[4], double translation_m[3]) {
  RotationToWire(rigid.rotation, quaternion_wxyz);
  for (int i = 0; i < 3; ++i) translation_m[i] = rigid.translation[i];
}

}  // namespace

calibration_t ToWire(const CalibrationMessage& message) {
  const CameraCalibration& calibration = message.calibration;
  calibration_t wire{};
  wire.utime = message.utime;
  wire.seq = message.seq;
  wire.camera = calibration.camera;
  wire.rig_hash = message.rig_hash;
  wire.method = message.method;
  wire.converged = static_cast<std::int8_t>(calibration.converged);
  wire.status = calibration.status;
  RigidToWire(calibration.camera_from_lidar, wire.quaternion_wxyz, wire.translation_m);
  wire.has_covariance = static_cast<std::int8_t>(calibration.covariance.has_value());
  if (calibration.covariance) CovarianceToWire(*calibration.covariance, wire.covariance);
  return wire;
}

void Check(const calibration_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckCameraName("camera", wire.camera);
  CheckName("rig_hash", wire.rig_hash, true);
  CheckName("method", wire.method, true);
  CheckText("status", wire.status);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  if (wire.has_covariance != 0) CheckCovariance(wire.covariance);
}

CalibrationMessage FromWire(const calibration_t& wire) {
  CalibrationMessage message;
  message.utime = wire.utime;
  message.seq = wire.seq;
  message.rig_hash = wire.rig_hash;
  message.method = wire.method;
  CameraCalibration& calibration = message.calibration;
  calibration.camera = wire.camera;
  calibration.converged = wire.converged != 0;
  calibration.status = wire.status;
  calibration.camera_from_lidar = {RotationFromWire(wire.quaternion_wxyz),
                                   Eigen::Vector3d(wire.translation_m)};
  if (wire.has_covariance != 0) calibration.covariance = CovarianceFromWire(wire.covariance);
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
  pose.map_from_lidar = {RotationFromWire(wire.quaternion_wxyz),
                         Eigen::Vector3d(wire.translation_m)};
  return pose;
}

}  // namespace rgbdt
