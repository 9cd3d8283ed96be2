#include "calib/methods/gradient_orientation/by_gradient_orientation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "calib/camera/project_points.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/methods/scene/seen_points.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

bool HasIntensity(const Shot& shot) { return shot.cloud->intensity.size() == shot.cloud->size(); }

CloudFeature FeatureOf(const std::vector<Shot>& shots, std::optional<CloudFeature> asked) {
  const auto without = std::find_if_not(shots.begin(), shots.end(), HasIntensity);
  if (!asked) {
    return without == shots.end() ? CloudFeature::kIntensity : CloudFeature::kRange;
  }
  if (*asked == CloudFeature::kIntensity && without != shots.end()) {
    throw InputError("gom: the cloud of view " + without->view +
                     " has no intensities; take gradients of the range");
  }
  return *asked;
}

// What the LIDAR resolves, in pixels at the image's middle.
double SmoothingOf(const Camera& camera, const Cloud& cloud) {
  const RangeGrid grid(cloud);
  const double step = std::min(grid.row_step() > 0 ? grid.row_step() : grid.column_step(),
                               grid.column_step() > 0 ? grid.column_step() : grid.row_step());
  return std::max(0.5, 0.5 * step * camera.lens().fx);
}

SceneFit FitOf(const Rigid3& pose, const std::string& why_not) {
  return {pose, std::nullopt, why_not.empty(), why_not};
}

}  // namespace

GradientAlignment::GradientAlignment(const CameraSpec& camera, const std::vector<Shot>& shots,
                                     const Rigid3& near, const GradientOrientationOptions& options)
    : camera_(camera) {
  const CloudFeature feature = FeatureOf(shots, options.feature);
  const std::vector<cv::Mat> grey = GreyValues(camera, shots);
  const std::size_t most = options.most_points / std::max<std::size_t>(1, shots.size());
  for (std::size_t s = 0; s < shots.size(); ++s) {
    shots_.push_back(Prepare(shots[s], grey[s], near, feature, most));
  }
}

GradientAlignment::Gradients GradientAlignment::Prepare(const Shot& shot, const cv::Mat& grey,
                                                        const Rigid3& near, CloudFeature feature,
                                                        std::size_t most) const {
  const std::vector<CloudGradient> all = GradientsOf(*shot.cloud, feature);
  std::vector<Eigen::Vector3f> points;
  points.reserve(all.size());
  for (const CloudGradient& g : all) points.push_back(shot.cloud->points[g.point]);
  Gradients out;
  for (const std::size_t i : PointsNearImage(camera_, near, points, most)) {
    constexpr float kAhead = 0.01F;  // [rad]
    out.pairs.push_back(points[i]);
    out.pairs.push_back(points[i] + kAhead * points[i].norm() * all[i].direction);
    out.strength.push_back(all[i].strength);
  }
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {}, SmoothingOf(camera_, *shot.cloud));
  cv::Sobel(smooth, out.along_x, CV_32F, 1, 0);
  cv::Sobel(smooth, out.along_y, CV_32F, 0, 1);
  return out;
}

void GradientAlignment::Add(const Gradients& shot, const Rigid3& camera_from_lidar,
                            Measure* measure) const {
  const PointProjector projector(camera_, camera_from_lidar);
  PixelBlock block;
  for (std::size_t first = 0; first < shot.pairs.size(); first += PixelBlock::kSize) {
    const std::size_t count = std::min(PixelBlock::kSize, shot.pairs.size() - first);
    projector.Project(&shot.pairs[first], count, &block);
    for (std::size_t i = 0; i < count; i += 2) {
      if (!IsSeen(camera_, block, i) || !(block.inverse_range[i + 1] > 0)) continue;
      const float u = block.u[i];
      const float v = block.v[i];
      const double x = block.u[i + 1] - u;
      const double y = block.v[i + 1] - v;
      const double gx = Interpolated(shot.along_x, u, v);
      const double gy = Interpolated(shot.along_y, u, v);
      const double strength = shot.strength[(first + i) / 2];
      measure->aligned += strength * std::abs(x * gx + y * gy) / std::sqrt(x * x + y * y);
      measure->strength += strength * std::sqrt(gx * gx + gy * gy);
      ++measure->seen;
    }
  }
}

GradientAlignment::Measure GradientAlignment::At(const Rigid3& camera_from_lidar) const {
  Measure measure;
  for (const Gradients& shot : shots_) Add(shot, camera_from_lidar, &measure);
  return measure;
}

SceneFit AlignByGradientOrientation(const CameraSpec& camera, const std::vector<Shot>& shots,
                                    const Rigid3& start,
                                    const GradientOrientationOptions& options) {
  const GradientAlignment alignment(camera, shots, start, options);
  // Few gradients are aligned by chance: a pose that sees few is worth nothing.
  const PoseObjective objective = [&](const Rigid3& pose) {
    const GradientAlignment::Measure measure = alignment.At(pose);
    return measure.seen < options.least_points ? 0 : measure.Gom();
  };
  const SwarmResult found = MaximiseBySwarm(objective, start, options.swarm);
  std::string why_not =
      WhyTooFew(alignment.At(found.pose).seen, options.least_points, "points with a gradient");
  if (why_not.empty() && found.at_border) why_not = WhyAtBorder(options.swarm.reach);
  if (why_not.empty()) {
    why_not = WhyNoPeak(ShareWorse(objective, found.pose, options.probe), options.least_worse,
                        options.probe);
  }
  return FitOf(found.pose, why_not);
}

}  // namespace rgbdt
