#include "calib/solve/evaluate.h"

#include <cmath>

#include "calib/camera/camera.h"
#include "calib/solve/distance_field.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

double DistanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::min(1.0, std::max(0.0, (p - a).dot(along) / length2)) : 0.0;
  return (p - a - t * along).norm();
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
  double MeanTransform() const { return transform / points; }
  double Rms() const { return std::sqrt(squared / points); }
};

Sums Judge(const Camera& camera, const CameraView& view, const Rigid3& camera_from_lidar) {
  const ImageEdges& image = *view.image;
  const DistanceField field(image.width, image.height, image.edge_pixels);
  const double unseen = 0.5 * image.width;
  Sums sums;
  for (const Eigen::Vector3d& point : view.cloud->boundary) {
    const auto pixel = camera.Project(camera_from_lidar * point);
    const double distance = pixel ? DistanceToOutline(*pixel, image.outline) : unseen;
    sums.transform += pixel ? field.Nearest(*pixel) : unseen;
    sums.squared += distance * distance;
    sums.points += 1;
  }
  return sums;
}

ViewQuality QualityOf(const CameraView& view, const Sums& sums) {
  ViewQuality quality;
  quality.view = view.view;
  quality.heldout = view.heldout;
  quality.distance_transform_px = sums.MeanTransform();
  quality.edge_rms_px = sums.Rms();
  return quality;
}

// Sum of the squared distances of a board's points from its plane.
void AddPoints(const EdgeModel& model, const CloudEdges& cloud, const Rigid3& lidar_from_target,
               EdgeMisfit* misfit) {
  if (!(cloud.raw_scatter(3, 3) > 0)) return;
  const PlaneResidual r =
      ResidualOf(cloud, lidar_from_target, model.shared[kRangeOffset], model.shared[kBeamsMeet]);
  if (cloud.groups.empty()) {
    misfit->plane_squared_m2 += r.x.dot(cloud.raw_scatter * r.x);
    misfit->points += cloud.raw_scatter(3, 3);
  }
  for (const PointGroup& group : cloud.groups) {
    double offset_m = 0;
    for (const auto& [term, part] : model.ranges.PartsOf(group)) {
      offset_m += part * model.range_terms[term];
    }
    const Eigen::Vector4d x = r.x + offset_m * r.by.col(3);
    misfit->plane_squared_m2 += x.dot(group.scatter * x);
    misfit->points += group.scatter(3, 3);
  }
}

// Nothing of nothing.
std::optional<double> Rms(double squared, double count) {
  return count > 0 ? std::optional(std::sqrt(squared / count)) : std::nullopt;
}

}  // namespace

double DistanceToOutline(const Eigen::Vector2d& pixel,
                         const std::vector<Eigen::Vector2d>& outline) {
  double best = 1e300;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    best = std::min(best, DistanceToSegment(pixel, outline[i], outline[(i + 1) % outline.size()]));
  }
  return best;
}

ViewQuality JudgeView(const CameraSpec& camera, const CameraView& view,
                      const Rigid3& camera_from_lidar) {
  return QualityOf(view, Judge(Camera(camera), view, camera_from_lidar));
}

CameraReport JudgeCamera(const CameraSpec& spec, const std::vector<const CameraView*>& usable,
                         CameraReport report) {
  const Camera camera(report.calibration.WithSolvedLens(spec));
  Sums train;
  Sums heldout;
  report.views.clear();
  for (const CameraView* view : usable) {
    const Sums sums = Judge(camera, *view, report.calibration.camera_from_lidar);
    report.views.push_back(QualityOf(*view, sums));
    (view->heldout ? heldout : train).Add(sums);
  }
  if (train.points > 0) {
    report.distance_transform_px.train = train.MeanTransform();
    report.edge_rms_px.train = train.Rms();
  }
  if (heldout.points > 0) {
    report.distance_transform_px.heldout = heldout.MeanTransform();
    report.edge_rms_px.heldout = heldout.Rms();
  }
  return report;
}

void EdgeMisfit::Add(const EdgeMisfit& other) {
  squared += other.squared;
  squared_m2 += other.squared_m2;
  count += other.count;
  plane_squared_m2 += other.plane_squared_m2;
  points += other.points;
}

std::optional<double> EdgeMisfit::RmsWhitened() const { return Rms(squared, count); }
std::optional<double> EdgeMisfit::RmsMm() const { return Rms(1e6 * squared_m2, count); }
std::optional<double> EdgeMisfit::PlaneRmsMm() const { return Rms(1e6 * plane_squared_m2, points); }

EdgeMisfit MisfitOfEdges(const EdgeModel& model, const CameraView& view,
                         const CameraCalibration& calibration) {
  EdgeMisfit misfit;
  if (!view.image->pose || !view.cloud->pose) return misfit;
  const TargetPose& seen = *view.image->pose;
  const Rigid3 lidar_from_camera = calibration.camera_from_lidar.Inverse();
  // The crossings' sides are told in the axes of the cloud's pose.
  Rigid3 camera_from_target = seen.sensor_from_target;
  if (HalfTurned(lidar_from_camera * camera_from_target, *view.cloud->pose)) {
    camera_from_target = camera_from_target * kHalfTurn;
  }
  Matrix6d covariance = kCornerSigmaInflation * kCornerSigmaInflation * seen.covariance;
  if (calibration.covariance) covariance += *calibration.covariance;
  const Matrix6d to_target = Adjoint(camera_from_target.Inverse());
  const Matrix6d in_target = to_target * covariance * to_target.transpose();
  const Rigid3 lidar_from_target = lidar_from_camera * camera_from_target;
  for (const Crossing& crossing : view.cloud->crossings) {
    if (!(crossing.sigma_m > 0)) continue;
    const CrossingResidual r =
        ResidualOf(model.target, model.priors, crossing, lidar_from_target, model.shared, 0);
    if (!(r.per_rad > 0)) continue;
    const double side = r.per_rad * model.priors.side_sigma_rad;
    const double variance = r.sigma_m * r.sigma_m + side * side +
                            (r.by_target * in_target * r.by_target.transpose()).value();
    misfit.squared += r.beyond_m * r.beyond_m / variance;
    misfit.squared_m2 += r.beyond_m * r.beyond_m;
    misfit.count += 1;
  }
  AddPoints(model, *view.cloud, lidar_from_target, &misfit);
  return misfit;
}

CameraReport JudgeEdges(const EdgeModel& model, const std::vector<const CameraView*>& usable,
                        CameraReport report) {
  EdgeMisfit train;
  EdgeMisfit heldout;
  for (const CameraView* view : usable) {
    const EdgeMisfit one = MisfitOfEdges(model, *view, report.calibration);
    (view->heldout ? heldout : train).Add(one);
    for (ViewQuality& quality : report.views) {
      if (quality.view != view->view) continue;
      quality.edge_rms_whitened = one.RmsWhitened();
      quality.edge_rms_mm = one.RmsMm();
      quality.plane_rms_mm = one.PlaneRmsMm();
    }
  }
  report.edge_rms_whitened = {train.RmsWhitened(), heldout.RmsWhitened()};
  report.edge_rms_mm = {train.RmsMm(), heldout.RmsMm()};
  report.plane_rms_mm = {train.PlaneRmsMm(), heldout.PlaneRmsMm()};
  return report;
}

}  // namespace rgbdt
