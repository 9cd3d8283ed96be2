#include "calib/model/calibration.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {

namespace {

const char* NameOf(SolveStatus status) {
  switch (status) {
    case SolveStatus::kNotSolved:
      return "not calibrated";
    case SolveStatus::kUndetermined:
    case SolveStatus::kDegenerate:
      return "degenerate";
    case SolveStatus::kNotConverged:
      return "not converged";
    case SolveStatus::kFirstGuessKept:
      return "converged; the first guess was kept";
    case SolveStatus::kContradicted:
      return "contradicted: do not use it";
    case SolveStatus::kConverged:
      break;
  }
  return "converged";
}

std::string TextOf(SolveStatus status, const std::string& detail) {
  return detail.empty() ? NameOf(status) : std::string(NameOf(status)) + ": " + detail;
}

// Of a chi-square over its degrees of freedom: its cube root is nearly normal (Wilson and Hilferty
// 1931).
double NormalOf(double mean_square, double freedom) {
  const double variance = 2 / (9 * freedom);
  return (std::cbrt(mean_square) - (1 - variance)) / std::sqrt(variance);
}

}  // namespace

std::string CameraCalibration::StatusText() const { return TextOf(status, detail); }

std::string LidarCalibration::StatusText() const { return TextOf(status, detail); }

PoseAndLensCovariance CameraCalibration::PoseAndLens() const {
  PoseAndLensCovariance out = WithExactLens(*covariance);
  if (!lens) return out;
  out.bottomRows<kLensNumbers>() = lens->covariance;
  out.topRightCorner<6, kLensNumbers>() = lens->covariance.leftCols<6>().transpose();
  return out;
}

CameraSpec CameraCalibration::WithSolvedLens(CameraSpec spec) const {
  if (lens) spec.lens = lens->lens;
  return spec;
}

Calibration Report::ToCalibration() const {
  Calibration calibration{method, rig_hash, utime, {}};
  for (const CameraReport& camera : cameras) {
    if (camera.calibration.solved()) calibration.cameras.push_back(camera.calibration);
  }
  for (const LidarReport& lidar : lidars) {
    if (lidar.calibration.solved()) calibration.lidars.push_back(lidar.calibration);
  }
  return calibration;
}

double ViewScatter::Chance() const {
  return freedom > 0 ? 0.5 * std::erfc(NormalOf(factor, freedom) / std::sqrt(2.0)) : 1;
}

double Cause::Sigmas() const {
  return freedom == 1 ? std::sqrt(chi2) : std::max(0.0, NormalOf(chi2 / freedom, freedom));
}

PoseError ErrorOfLidar(const Rigid3& estimate, const Rigid3& truth) {
  return {RotationDistance(estimate, truth) * 180.0 / M_PI,
          (estimate.translation - truth.translation).norm() * 1000.0};
}

PoseError ErrorOf(const Rigid3& estimate, const Rigid3& truth) {
  return {RotationDistance(estimate, truth) * 180.0 / M_PI,
          CentreDistance(estimate, truth) * 1000.0};
}

Report WithTruth(Report report, const Truth& truth) {
  for (CameraReport& camera : report.cameras) {
    const auto found = truth.camera_from_lidar.find(camera.calibration.camera);
    if (found == truth.camera_from_lidar.end()) continue;
    if (camera.first_guess) {
      camera.first_guess_error = ErrorOf(*camera.first_guess, found->second);
    }
    camera.truth_error = ErrorOf(camera.calibration.camera_from_lidar, found->second);
    for (StartResult& start : camera.other_starts) {
      start.truth_error = ErrorOf(start.calibration.camera_from_lidar, found->second);
    }
  }
  for (LidarReport& lidar : report.lidars) {
    const auto found = truth.reference_from_lidar.find(lidar.calibration.lidar);
    if (found == truth.reference_from_lidar.end()) continue;
    lidar.truth_error = ErrorOfLidar(lidar.calibration.reference_from_lidar, found->second);
  }
  return report;
}

}  // namespace rgbdt
