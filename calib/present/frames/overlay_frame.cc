#include "calib/present/frames/overlay_frame.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "calib/camera/project_points.h"
#include "calib/present/frames/internal/scatter.h"
#include "calib/present/layout/frame.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Eigen::Vector3d> Scattered(const std::vector<Eigen::Vector3d>& all, std::size_t most) {
  std::vector<Eigen::Vector3d> some;
  const std::size_t count = std::min(all.size(), most);
  some.reserve(count);
  const Scatter scatter(all.size());
  for (std::uint64_t i = 0; some.size() < count; i = scatter.Next(i)) some.push_back(all[i]);
  return some;
}

std::vector<Eigen::Vector3d> EdgeOn(const Camera& camera, const Rigid3& camera_from_lidar,
                                    const std::vector<Eigen::Vector3d>& boundary,
                                    const std::vector<Eigen::Vector2d>& outline) {
  std::vector<Eigen::Vector3d> edge;
  for (const Eigen::Vector3d& point : boundary) {
    const auto pixel = camera.Project(camera_from_lidar * point);
    if (!pixel || !camera.Contains(*pixel)) continue;
    const double distance = outline.empty() ? kNan : DistanceToOutline(*pixel, outline);
    edge.emplace_back(pixel->x(), pixel->y(), distance);
  }
  return edge;
}

std::string TextOf(const CameraView& view) {
  if (!view.usable()) return view.rejected;
  return view.heldout ? "board found; held out" : "board found";
}

template <typename Vector>
std::vector<float> Flat(const std::vector<Vector>& vectors) {
  std::vector<float> numbers;
  numbers.reserve(vectors.size() * static_cast<std::size_t>(Vector::SizeAtCompileTime));
  for (const Vector& vector : vectors) {
    for (const double number : vector) numbers.push_back(static_cast<float>(number));
  }
  return numbers;
}

}  // namespace

std::vector<Eigen::Vector3d> LayOnImage(const CameraSpec& spec, const Rigid3& camera_from_lidar,
                                        const std::vector<Eigen::Vector3f>& points,
                                        std::size_t most) {
  const Camera camera(spec);
  std::vector<Eigen::Vector3d> seen;
  const auto take = [&](std::size_t, std::size_t count, const PixelBlock& block) {
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d pixel(block.u[i], block.v[i]);
      if (!(block.inverse_range[i] > 0) || !camera.Contains(pixel)) continue;
      seen.emplace_back(pixel.x(), pixel.y(), 1.0 / block.inverse_range[i]);
    }
  };
  PointProjector(camera, camera_from_lidar)
      .ForBlocks(ViewBounds(camera), BlockedPoints(points), 0, points.size(), take);
  return Scattered(seen, most);
}

Cloud SomePoints(const Cloud& cloud, std::size_t most) {
  Cloud some;
  some.sweep_utime = cloud.sweep_utime;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / most);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (!cloud.points[i].allFinite()) continue;
    some.points.push_back(cloud.points[i]);
    if (!cloud.intensity.empty()) some.intensity.push_back(cloud.intensity[i]);
  }
  some.lines = 1;
  some.beams = static_cast<int>(some.points.size());
  return some;
}

Overlay ViewOverlay(const CameraSpec& camera, const ViewDetection& detection, const Cloud* cloud,
                    const std::optional<Rigid3>& camera_from_lidar) {
  const CameraView view = CameraViewOf(camera.name, detection);
  Overlay overlay;
  overlay.camera = camera.name;
  overlay.view = view.view;
  overlay.utime = view.image_utime;
  overlay.calibrated = camera_from_lidar.has_value();
  if (view.image != nullptr) {
    const auto& corners = view.image->corners;
    std::copy_if(corners.begin(), corners.end(), std::back_inserter(overlay.corners), IsSeen);
    overlay.outline = view.image->outline;
  }
  if (!camera_from_lidar) {
    overlay.text = TextOf(view);
    return overlay;
  }
  const CameraView chosen = WithChosenCandidate(view, *camera_from_lidar, kJudgeGate);
  overlay.text = TextOf(chosen);
  if (chosen.cloud) {
    overlay.edge =
        EdgeOn(Camera(camera), *camera_from_lidar, chosen.cloud->boundary, overlay.outline);
  }
  if (cloud != nullptr) overlay.cloud = LayOnImage(camera, *camera_from_lidar, cloud->points);
  return overlay;
}

std::string OverlayFrame(const Overlay& overlay, bool ack) {
  FrameWriter frame({{"type", "overlay"},
                     {"camera", overlay.camera},
                     {"view", overlay.view},
                     {"utime", overlay.utime},
                     {"calibrated", overlay.calibrated},
                     {"text", overlay.text},
                     {"ack", ack}});
  frame.AddFloats("corners", Flat(overlay.corners));
  frame.AddFloats("outline", Flat(overlay.outline));
  frame.AddFloats("edge", Flat(overlay.edge));
  frame.AddFloats("cloud", Flat(overlay.cloud));
  return frame.Finish();
}

}  // namespace rgbdt
