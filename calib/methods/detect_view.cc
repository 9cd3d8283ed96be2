#include "calib/methods/detect_view.h"

#include <algorithm>
#include <optional>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/image/image_edges.h"
#include "calib/detect/image/stillness.h"
#include "calib/methods/paper/cloud_edges.h"
#include "calib/model/stopwatch.h"

namespace rgbdt {
namespace {

Observation Empty(const View& view, const std::string& camera) {
  Observation observation;
  observation.view = view.name;
  observation.camera = camera;
  observation.heldout = view.heldout;
  observation.sweep_utime = view.cloud.sweep_utime;
  return observation;
}

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
  if (others.empty() || !edges.pose) return "";  // picks alone are too inexact
  return WhyNotStill(Camera(spec), target, ToGrey(image), edges.corners, others);
}

// Picks are the paper's outline; otherwise they are for a board that is not found without them.
ImageEdgesResult FindEdges(const CameraSpec& spec, const Target& target, const Image& image,
                           const CornerSelection* picks, bool by_paper) {
  const Camera camera(spec);
  ImageEdgesResult found =
      DetectImageEdges(image, camera, target, by_paper ? picks : nullptr, spec.kind);
  if (found.edges || by_paper || picks == nullptr) return found;
  return MeasurePickedBoard(image, camera, target, *picks, spec.kind);
}

void DetectImage(const CameraSpec& spec, const Target& target, const View& view, const Image& image,
                 bool by_paper, Observation* observation) {
  const Stopwatch watch;
  observation->image_utime = image.utime;
  ImageEdgesResult found = FindEdges(spec, target, image, PicksOf(spec.name, view), by_paper);
  observation->rejected = found.why;
  observation->image = std::move(found.edges);
  if (observation->image) {
    observation->rejected = WhyMoved(spec, target, view, image, *observation->image);
  }
  observation->detect_image_s = watch.Seconds();
}

void DetectCloudByGuess(const CameraSpec& spec, const Target& target, const Cloud& cloud,
                        Observation* observation) {
  if (!spec.camera_from_lidar_guess) {
    observation->rejected =
        "the rig file has no camera_from_lidar_guess for this camera; the "
        "paper's method needs one";
    return;
  }
  observation->rejected = WhySweepIsTorn(cloud);
  if (!observation->rejected.empty()) return;
  const Stopwatch watch;
  CloudEdgesResult found = DetectCloudEdges(cloud, Camera(spec), *spec.camera_from_lidar_guess,
                                            observation->image->corners, target);
  observation->detect_cloud_s = watch.Seconds();
  observation->rejected = found.why;
  observation->cloud = std::move(found.edges);
}

// What the cloud shows is the same for all cameras.
struct CloudLook {
  BoardsInCloud boards;
  double seconds = 0;
};

CloudLook LookAtCloud(const Rig& rig, const Cloud& cloud) {
  CloudLook look;
  look.boards.why = WhySweepIsTorn(cloud);
  if (!look.boards.why.empty()) return look;
  const Stopwatch watch;
  BoardInCloudOptions options;
  options.range_sigma_m = rig.lidar.range_sigma_m;
  look.boards = FindBoards(cloud, rig.target, options);
  look.seconds = watch.Seconds();
  return look;
}

void UseCloudLook(const CloudLook& look, Observation* observation) {
  observation->detect_cloud_s = look.seconds;
  if (look.boards.candidates.empty()) {
    observation->rejected = look.boards.why;
    return;
  }
  observation->candidates = look.boards.candidates;
  observation->cloud = look.boards.candidates.front();  // until the views together choose
}

}  // namespace

std::vector<Observation> DetectView(const Rig& rig, const View& view, const std::string& method) {
  RequireMethod(method);
  const bool by_paper = method == kPaperMethod;
  std::optional<CloudLook> look;
  std::vector<Observation> observations;
  for (const CameraSpec& camera : rig.cameras) {
    Observation& observation = observations.emplace_back(Empty(view, camera.name));
    const Image* image = FirstImageOf(camera.name, view);
    if (image == nullptr) {
      observation.rejected = "the view has no image of this camera";
      continue;
    }
    CheckImage(camera, *image);
    DetectImage(camera, rig.target, view, *image, by_paper, &observation);
    if (!observation.rejected.empty()) continue;
    if (by_paper) {
      DetectCloudByGuess(camera, rig.target, view.cloud, &observation);
    } else {
      if (!look) look = LookAtCloud(rig, view.cloud);
      UseCloudLook(*look, &observation);
    }
  }
  return observations;
}

}  // namespace rgbdt
