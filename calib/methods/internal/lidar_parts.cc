#include "calib/methods/internal/lidar_parts.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "calib/model/pose_sigma.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// From a board's middle in one cloud to the nearest one in the other [m], the reference's axes;
// infinite where one of them has none.
double DistanceBetween(const Rigid3& reference_from_lidar, const CloudDetection& reference,
                       const CloudDetection& further) {
  double least = std::numeric_limits<double>::infinity();
  for (const CloudEdges& a : reference.candidates) {
    for (const CloudEdges& b : further.candidates) {
      if (!a.pose || !b.pose) continue;
      const Eigen::Vector3d there = reference_from_lidar * b.pose->sensor_from_target.translation;
      least = std::min(least, (there - a.pose->sensor_from_target.translation).norm());
    }
  }
  return least;
}

}  // namespace

void SayNotCalibrated(const std::string& lidar, const std::string& why,
                      std::vector<CameraViews>* cameras) {
  const std::string warning = "LIDAR " + lidar + " is not calibrated: " + why;
  for (CameraViews& camera : *cameras) camera.report.warnings.push_back(warning);
}

std::vector<LidarViews> WithClouds(std::vector<LidarViews> lidars,
                                   std::vector<CameraViews>* cameras) {
  std::vector<LidarViews> with;
  for (LidarViews& lidar : lidars) {
    if (lidar.candidates.empty() && lidar.report.rejected.empty()) {
      SayNotCalibrated(lidar.report.calibration.lidar,
                       "no view has a cloud of it; name them in the views of a recorded session "
                       "(further_cloud in view.textproto; live sessions have one LIDAR)",
                       cameras);
    } else {
      with.push_back(std::move(lidar));
    }
  }
  return with;
}

LidarReport JudgedLidar(const LidarCalibration& lidar,
                        const std::vector<ViewDetection>& detections) {
  constexpr double kMost = 0.1;  // [m]; a board's middle is known to a few centimetres
  LidarReport report;
  report.calibration = lidar;
  if (lidar.covariance) report.sigma = SigmaOf(lidar);
  if (!lidar.solved()) return report;
  std::vector<double> distances;
  for (const ViewDetection& view : detections) {
    for (const LidarDetection& further : view.further_clouds) {
      if (further.lidar != lidar.lidar) continue;
      const double distance =
          DistanceBetween(lidar.reference_from_lidar, view.cloud, further.cloud);
      if (!(distance < std::numeric_limits<double>::infinity())) continue;
      distances.push_back(distance);
      report.used.push_back(view.view);
    }
  }
  if (distances.empty()) {
    report.warnings.emplace_back(
        "no view by which to judge this pose: none has the board in its "
        "cloud and in the reference's");
    return report;
  }
  const double median = Median(distances);
  const std::string found = Format(
      "on these views the board's middle lies %.0f mm from where the reference has it "
      "(median of %d)",
      1000 * median, static_cast<int>(distances.size()));
  if (median > kMost && lidar.converged()) {
    report.calibration.status = SolveStatus::kContradicted;
    report.calibration.detail = found + "; did the LIDAR move? Calibrate anew";
  } else {
    report.warnings.push_back(found);
  }
  return report;
}

}  // namespace rgbdt
