#include "calib/methods/detect_view.h"

#include <algorithm>
#include <optional>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/detect/cloud/turn_rate.h"
#include "calib/detect/image/image_edges.h"
#include "calib/detect/image/stillness.h"
#include "calib/methods/bearing_angle/board_corners.h"
#include "calib/methods/line_scan/board_lines.h"
#include "calib/methods/paper/cloud_edges.h"
#include "calib/methods/single_shot/planar_patches.h"
#include "calib/model/errors.h"
#include "calib/model/stopwatch.h"

namespace rgbdt {
namespace {

const Image* FirstImageOf(const std::string& camera, const View& view) {
  const auto found = std::find_if(view.images.begin(), view.images.end(),
                                  [&](const Image& image) { return image.camera == camera; });
  return found == view.images.end() ? nullptr : &*found;
}

const CornerSelection* PicksOf(const std::string& camera, const View& view) {
  const auto found =
      std::find_if(view.picks.begin(), view.picks.end(),
                   [&](const CornerSelection& picks) { return picks.camera == camera; });
  return found == view.picks.end() ? nullptr : &*found;
}

// Why a sweep cannot be used as it came; empty: it can. Gaps look like edges.
std::string WhySweepIsTorn(const Cloud& cloud) {
  const int lost = LostLines(cloud);
  if (lost * 100 <= cloud.lines) return "";
  return std::to_string(lost) + " of the sweep's " + std::to_string(cloud.lines) +
         " lines were lost on the way; look at the assembler's status";
}

// Whether the board moved between the camera's images in this view; empty: it stood still.
std::string WhyMoved(const CameraSpec& spec, const Target& target, const View& view,
                     const Image& image, const ImageEdges& edges) {
  std::vector<SweepImage> others;
  for (const Image& other : view.images) {
    if (other.camera != spec.name || &other == &image) continue;
    CheckImage(spec, other);
    others.push_back({ToGrey(other), ToSeconds(other.utime - view.cloud.sweep_utime)});
  }
  if (others.empty() || !edges.pose || edges.corners.empty())
    return "";  // picks alone are too inexact
  return WhyNotStill(Camera(spec), target, ToGrey(image), edges.corners, others);
}

// Picks are the paper's outline; otherwise they are for a board that is not found without them.
ImageEdgesResult FindEdges(const CameraSpec& spec, const Target& target, const Image& image,
                           const CornerSelection* picks, bool by_paper) {
  const Camera camera(spec);
  ImageEdgesResult found =
      DetectImageEdges(image, camera, target, by_paper ? picks : nullptr, spec.kind);
  // Markers tell all that picks could.
  const bool picks_help = target.HasPattern() && !target.markers;
  if (found.edges || by_paper || !picks_help) return found;
  if (picks != nullptr) return MeasurePickedBoard(image, camera, target, *picks, spec.kind);
  ImageEdgesResult by_opencv = MeasureWhereOpenCvSees(image, camera, target, spec.kind);
  if (by_opencv.edges) return by_opencv;
  if (!by_opencv.why.empty()) {
    found.why += "; OpenCV sees one, but " + by_opencv.why;
  }
  return found;
}

ImageDetection DetectImage(const CameraSpec& spec, const Target& target, const View& view,
                           bool by_paper) {
  ImageDetection detection;
  detection.camera = spec.name;
  const Image* image = FirstImageOf(spec.name, view);
  if (image == nullptr) {
    detection.why_not = "the view has no image of this camera";
    return detection;
  }
  CheckImage(spec, *image);
  const Stopwatch watch;
  detection.utime = image->utime;
  ImageEdgesResult found = FindEdges(spec, target, *image, PicksOf(spec.name, view), by_paper);
  detection.why_not = found.why;
  detection.edges = std::move(found.edges);
  if (detection.edges) detection.why_not = WhyMoved(spec, target, view, *image, *detection.edges);
  detection.detect_s = watch.Seconds();
  return detection;
}

// The paper's method finds the board where one camera's corners and guess say.
CloudEdgesResult FindByGuess(const CameraSpec& spec, const Target& target, const Cloud& cloud,
                             const ImageEdges& image) {
  if (!spec.camera_from_lidar_guess) {
    return {std::nullopt,
            "the rig file has no camera_from_lidar_guess for this camera; the paper's method needs "
            "one"};
  }
  CloudEdgesResult found =
      DetectCloudEdges(cloud, Camera(spec), *spec.camera_from_lidar_guess, image.corners, target);
  if (found.edges) found.edges->camera = spec.name;
  return found;
}

void DetectCloudByGuesses(const Rig& rig, const Cloud& cloud,
                          const std::vector<ImageDetection>& images, CloudDetection* detection) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!images[i].usable()) continue;
    CloudEdgesResult found = FindByGuess(rig.cameras[i], rig.target, cloud, *images[i].edges);
    if (found.edges) {
      detection->candidates.push_back(std::move(*found.edges));
    } else {
      detection->why_not +=
          (detection->why_not.empty() ? "" : "; ") + images[i].camera + ": " + found.why;
    }
  }
  if (detection->candidates.empty() && detection->why_not.empty()) {
    detection->why_not = "not searched: the paper's method needs the board in an image first";
  }
}

void DetectCloudAnywhere(const Rig& rig, const Cloud& cloud, CloudDetection* detection) {
  BoardsInCloud boards = FindBoards(cloud, rig.target, OptionsFor(rig.lidar));
  detection->candidates = std::move(boards.candidates);
  if (detection->candidates.empty()) detection->why_not = boards.why;
}

// The same boards, with what a method takes of them.
void TakeLines(const Rig& rig, const Cloud& cloud, CloudDetection* detection) {
  for (CloudEdges& board : detection->candidates) {
    board.groups = LinesOnBoard(cloud, board, rig.target, rig.lidar.range_sigma_m);
  }
}

void TakeCorners(const Rig& rig, const Cloud& cloud, CloudDetection* detection) {
  BoardCornerOptions options;
  options.range_sigma_m = rig.lidar.range_sigma_m;
  const RangeGrid grid(cloud);
  for (CloudEdges& board : detection->candidates) {
    board.corners = PickBoardCorners(grid, board, rig.target, options);
  }
}

void DetectPatches(const Rig& rig, const Cloud& cloud, CloudDetection* detection) {
  PatchOptions options;
  options.range_sigma_m = rig.lidar.range_sigma_m;
  detection->candidates = PlanarPatches(cloud, rig.target, options);
  if (detection->candidates.empty()) {
    detection->why_not = "no plane about as large as the target in the cloud";
  }
}

CloudDetection DetectCloud(const Rig& rig, const Cloud& cloud,
                           const std::vector<ImageDetection>& images, const std::string& method) {
  CloudDetection detection;
  detection.why_not = WhySweepIsTorn(cloud);
  if (!detection.why_not.empty()) return detection;
  const Stopwatch watch;
  if (method == kPaperMethod) {
    DetectCloudByGuesses(rig, cloud, images, &detection);
  } else if (method == kSingleShotMethod) {
    DetectPatches(rig, cloud, &detection);
  } else {
    DetectCloudAnywhere(rig, cloud, &detection);
  }
  if (method == kLineScanMethod) TakeLines(rig, cloud, &detection);
  if (method == kBearingAngleMethod) TakeCorners(rig, cloud, &detection);
  if (rig.lidar.turned_scanner) {
    for (CloudEdges& board : detection.candidates) board.turn_rad_s = TurnRate(cloud, board.centre);
  }
  detection.detect_s = watch.Seconds();
  return detection;
}

// Of the LIDARs beside the reference. Only "auto" solves for their poses.
std::vector<LidarDetection> DetectFurther(const Rig& rig, const View& view) {
  std::vector<LidarDetection> detections;
  for (const LidarSpec& lidar : rig.further_lidars) {
    const auto found =
        std::find_if(view.further_clouds.begin(), view.further_clouds.end(),
                     [&](const LidarCloud& cloud) { return cloud.lidar == lidar.name; });
    if (found == view.further_clouds.end()) continue;  // a view need not have one
    Rig as_reference = rig;
    as_reference.lidar = lidar;
    detections.push_back({lidar.name, DetectCloud(as_reference, found->cloud, {}, kAutoMethod)});
  }
  return detections;
}

}  // namespace

ViewDetection DetectView(const Rig& rig, const View& view, const std::string& method) {
  RequireMethod(method);
  if (rig.target.WhiteToTheRim() && method != kAutoMethod) {
    throw InputError("method \"" + method + "\" needs a checkerboard; the rig's target " +
                     (rig.target.holes ? "has holes" : "is plain"));
  }
  const bool by_paper = method == kPaperMethod;
  ViewDetection detection;
  detection.view = view.name;
  detection.heldout = view.heldout;
  detection.sweep_utime = view.cloud.sweep_utime;
  for (const CameraSpec& camera : rig.cameras) {
    detection.images.push_back(DetectImage(camera, rig.target, view, by_paper));
  }
  detection.cloud = DetectCloud(rig, view.cloud, detection.images, method);
  if (method == kAutoMethod) detection.further_clouds = DetectFurther(rig, view);
  return detection;
}

}  // namespace rgbdt
