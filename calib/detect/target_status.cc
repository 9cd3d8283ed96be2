#include "calib/detect/target_status.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/image_edges.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kEnoughPixels = 1000;  // across the image
constexpr int kPiecesOfASide = 16;

// Pixel centres lie at integers: (x + 0.5) scales, not x.
Eigen::Vector2d Scaled(const Eigen::Vector2d& place, double scale) {
  return (place.array() + 0.5) * scale - 0.5;
}

std::vector<Eigen::Vector2d> OutlineOf(const Camera& camera, const Target& target,
                                       const Rigid3& camera_from_target) {
  std::vector<Eigen::Vector2d> outline;
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto side =
        ProjectSegment(camera, camera_from_target * corners[i],
                       camera_from_target * corners[(i + 1) % corners.size()], kPiecesOfASide);
    outline.insert(outline.end(), side.begin(), side.end());
  }
  return outline;
}

// Without a pattern, or where a camera may not see it: by its outline, as exactly as for the solve.
TargetStatus LookForPlain(const CameraSpec& spec, const Target& target, const Image& image,
                          TargetStatus status) {
  const Camera camera(spec);
  const ImageEdgesResult found = DetectImageEdges(image, camera, target, nullptr, spec.kind);
  status.text = found.why;
  if (!found.edges) return status;
  const Rigid3& camera_from_target = found.edges->pose->sensor_from_target;
  status.seen = true;
  status.outline = OutlineOf(camera, target, camera_from_target);
  status.text = Format("%.1f m away", camera_from_target.translation.norm());
  return status;
}

}  // namespace

TargetStatus LookForTarget(const Rig& rig, const Image& image) {
  const CameraSpec& spec = rig.Camera(image.camera);
  CheckImage(spec, image);
  TargetStatus status;
  status.camera = image.camera;
  status.utime = image.utime;
  if (!rig.target.HasPattern() || MarkersMayHide(rig.target, spec.kind)) {
    return LookForPlain(spec, rig.target, image, std::move(status));
  }
  cv::Mat grey = ToGrey(image);
  const double shrink = std::max(1.0, std::round(grey.cols / kEnoughPixels));
  if (shrink > 1) cv::resize(grey, grey, {}, 1 / shrink, 1 / shrink, cv::INTER_AREA);
  const CheckerboardResult found = FindCheckerboard(grey, rig.target, SaturatedFrom(image));
  status.text = found.why;
  if (!found.board) return status;
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& corner : found.board->corners) {
    corners.push_back(Scaled(corner, shrink));
  }
  std::copy_if(corners.begin(), corners.end(), std::back_inserter(status.corners), IsSeen);
  const Camera camera(spec);
  const auto pose = PoseFromCorners(camera, rig.target, corners);
  if (!pose) {
    status.text = "a checkerboard that is not flat; check the lens in the rig file";
    return status;
  }
  status.seen = true;
  const Rigid3& camera_from_target = pose->pose.sensor_from_target;
  status.outline = OutlineOf(camera, rig.target, camera_from_target);
  status.text = Format("%.1f m away", camera_from_target.translation.norm());
  return status;
}

TargetStatus LookForTarget(const Rig& rig, const Cloud& cloud) {
  TargetStatus status;
  status.utime = cloud.sweep_utime;
  const BoardsInCloud boards = FindBoards(cloud, rig.target, OptionsFor(rig.lidar));
  status.text = boards.why;
  if (boards.candidates.empty()) return status;
  status.seen = true;
  status.centre = boards.candidates.front().centre;
  status.text = Format("%.1f m away", status.centre.norm());
  return status;
}

}  // namespace rgbdt
