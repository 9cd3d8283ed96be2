#include "calib/solve/evaluate.h"

#include <cmath>

#include "calib/camera/camera.h"
#include "calib/solve/distance_field.h"

namespace rgbdt {
namespace {

double DistanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::min(1.0, std::max(0.0, (p - a).dot(along) / length2)) : 0.0;
  return (p - a - t * along).norm();
}

double DistanceToChain(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& chain) {
  double best = 1e300;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    best = std::min(best, DistanceToSegment(p, chain[i], chain[(i + 1) % chain.size()]));
  }
  return best;
}

struct Sums {
  double transform = 0;  // sum of distance-transform values [px]
  double squared = 0;    // sum of squared distances to the outline [px^2]
  double points = 0;

  void Add(const Sums& other) {
    transform += other.transform;
    squared += other.squared;
    points += other.points;
  }
};

Sums Judge(const Camera& camera, const Observation& observation, const Rigid3& camera_from_lidar) {
  const ImageEdges& image = *observation.image;
  const DistanceField field(image.width, image.height, image.edge_pixels);
  const double unseen = 0.5 * image.width;
  Sums sums;
  for (const Eigen::Vector3d& point : observation.cloud->boundary) {
    const auto pixel = camera.Project(camera_from_lidar * point);
    const double distance = pixel ? DistanceToChain(*pixel, image.outline) : unseen;
    sums.transform += pixel ? field.Nearest(*pixel) : unseen;
    sums.squared += distance * distance;
    sums.points += 1;
  }
  return sums;
}

ViewQuality QualityOf(const Observation& observation, const Sums& sums) {
  return {observation.view, observation.heldout, sums.transform / sums.points,
          std::sqrt(sums.squared / sums.points)};
}

}  // namespace

ViewQuality JudgeView(const CameraSpec& camera, const Observation& observation,
                      const Rigid3& camera_from_lidar) {
  return QualityOf(observation, Judge(Camera(camera), observation, camera_from_lidar));
}

void JudgeCamera(const CameraSpec& spec, const std::vector<const Observation*>& usable,
                 CameraReport* report) {
  const Camera camera(spec);
  Sums train;
  Sums heldout;
  report->views.clear();
  for (const Observation* observation : usable) {
    const Sums sums = Judge(camera, *observation, report->calibration.camera_from_lidar);
    report->views.push_back(QualityOf(*observation, sums));
    (observation->heldout ? heldout : train).Add(sums);
  }
  const auto fill = [](const Sums& sums, std::optional<double>* transform,
                       std::optional<double>* rms) {
    if (sums.points == 0) return;
    *transform = sums.transform / sums.points;
    *rms = std::sqrt(sums.squared / sums.points);
  };
  fill(train, &report->distance_transform_px.train, &report->edge_rms_px.train);
  fill(heldout, &report->distance_transform_px.heldout, &report->edge_rms_px.heldout);
}

}  // namespace rgbdt
