#include "calib/solve/camera_views.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/camera/target_pose.h"

namespace rgbdt {
namespace {

// Detections from the bus may be well formed and still hold nothing to solve with.
void RejectEmpty(const CameraSpec& camera, CameraView* view) {
  if (!view->usable()) return;
  auto& candidates = view->candidates;
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [](const CloudEdges* c) { return c->boundary.empty(); }),
                   candidates.end());
  const ImageEdges& image = *view->image;
  if (image.edge_pixels.empty() || image.outline.empty()) {
    view->Reject("the detection has no edges in the image");
  } else if (candidates.empty()) {
    view->Reject("the detection has no boundary points in the cloud");
  } else if (image.width != camera.width || image.height != camera.height) {
    view->Reject("the detection's image is " + std::to_string(image.width) + "x" +
                 std::to_string(image.height) + ", the rig file says " +
                 std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  if (view->usable()) view->cloud = *candidates.front();
}

// Noise makes no two images, and no two sweeps, alike to the last bit.
bool IsSameImage(const CameraView& a, const CameraView& b) {
  return a.image->outline_corners == b.image->outline_corners &&
         a.image->edge_pixels == b.image->edge_pixels;
}

bool IsSameCloud(const CameraView& a, const CameraView& b) {
  return a.cloud->centre == b.cloud->centre && a.cloud->normal == b.cloud->normal &&
         a.cloud->boundary == b.cloud->boundary;
}

// A view that is a copy tells nothing new, and would make the result look better known than it is,
// or, held out, better checked.
void RejectCopies(std::vector<CameraView>* views) {
  for (std::size_t i = 1; i < views->size(); ++i) {
    CameraView& view = (*views)[i];
    for (std::size_t k = 0; k < i && view.usable(); ++k) {
      const CameraView& other = (*views)[k];
      if (!other.usable()) continue;
      const char* same = IsSameImage(view, other)   ? "image"
                         : IsSameCloud(view, other) ? "cloud"
                                                    : nullptr;
      if (same == nullptr) continue;
      view.copy = true;
      view.Reject(std::string("its ") + same + " is that of view " + other.view +
                  ": it counts once");
    }
  }
}

bool SeesAllCorners(const ImageEdges& image) {
  return std::all_of(image.corners.begin(), image.corners.end(), &IsSeen);
}

// Whether the board's size is known to be as the rig file has it: a board of another size, cut by
// the image's edge along the very side by which it differs, looks like it.
bool IsSeenWhole(const std::vector<ViewDetection>& detections) {
  return std::any_of(detections.begin(), detections.end(), [](const ViewDetection& view) {
    return std::any_of(view.images.begin(), view.images.end(), [](const ImageDetection& image) {
      return image.edges && !image.edges->picked && SeesAllCorners(*image.edges);
    });
  });
}

std::string WhyNoImage(const ImageDetection* image) {
  if (image == nullptr) return "the view has no image of this camera";
  if (!image->why_not.empty()) return image->why_not;
  return image->edges ? "" : "the board was not found in the image";
}

std::string WhyNoCloud(const CameraView& view, const CloudDetection& cloud) {
  if (!view.candidates.empty()) return "";
  return cloud.why_not.empty() ? "the board was not found in the cloud" : cloud.why_not;
}

std::string Joined(const std::string& no_image, const std::string& no_cloud) {
  if (no_image.empty() || no_image == no_cloud) return no_cloud;  // e.g. of an unreadable view
  if (no_cloud.empty()) return no_image;
  return "image: " + no_image + "; cloud: " + no_cloud;
}

// The outline of the board at a pose, as the lens bends it.
std::vector<Eigen::Vector2d> OutlineAt(const Camera& camera, const Target& target,
                                       const Rigid3& camera_from_target) {
  constexpr int kPieces = 32;
  std::vector<Eigen::Vector2d> outline;
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto side = ProjectSegment(camera, camera_from_target * corners[i],
                                     camera_from_target * corners[(i + 1) % 4], kPieces);
    outline.insert(outline.end(), side.begin(), side.end());
  }
  return outline;
}

// Whether two lenses have the outline in places that are farther apart than the detection looks to
// either side of where the one that was given has it: what it found there is not the board's edge.
bool AreApart(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  constexpr double kReachPx = 3;
  if (a.size() != b.size()) return true;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if ((a[i] - b[i]).norm() > kReachPx) return true;
  }
  return false;
}

}  // namespace

void CameraView::Reject(const std::string& why) {
  if (rejected.empty()) rejected = why;
}

CameraView CameraViewOf(const std::string& camera, const ViewDetection& detection) {
  CameraView view;
  view.view = detection.view;
  view.heldout = detection.heldout;
  const ImageDetection* image = detection.Find(camera);
  if (image != nullptr) {
    view.image_utime = image->utime;
    if (image->edges) view.image = &*image->edges;
  }
  for (const CloudEdges& candidate : detection.cloud.candidates) {
    if (candidate.camera.empty() || candidate.camera == camera) {
      view.candidates.push_back(&candidate);
    }
  }
  if (!view.candidates.empty()) view.cloud = *view.candidates.front();
  view.rejected = Joined(WhyNoImage(image), WhyNoCloud(view, detection.cloud));
  return view;
}

std::vector<const CameraView*> CameraViews::Usable() const {
  std::vector<const CameraView*> usable;
  for (const CameraView& view : all) {
    if (view.usable()) usable.push_back(&view);
  }
  return usable;
}

std::vector<const CameraView*> CameraViews::Used() const {
  std::vector<const CameraView*> used = Usable();
  used.erase(std::remove_if(used.begin(), used.end(), [](auto* view) { return view->heldout; }),
             used.end());
  return used;
}

const CameraView* CameraViews::Find(const std::string& view) const {
  for (const CameraView* used : Used()) {
    if (used->view == view) return used;
  }
  return nullptr;
}

void CameraViews::Describe() {
  for (const CameraView& view : all) {
    if (!view.usable()) {
      report.rejected.push_back({view.view, view.rejected, view.copy});
    } else {
      (view.heldout ? report.heldout : report.used).push_back(view.view);
    }
  }
}

CameraViews ViewsOf(const CameraSpec& camera, const std::vector<ViewDetection>& detections) {
  CameraViews views;
  views.spec = &camera;
  views.report.calibration.camera = camera.name;
  std::vector<const ViewDetection*> in_order;
  for (const ViewDetection& detection : detections) {
    const ImageDetection* image = detection.Find(camera.name);
    if (image == nullptr) continue;
    in_order.push_back(&detection);
    views.report.detect_image_s += image->detect_s;
    views.report.detect_cloud_s += detection.cloud.detect_s;
  }
  std::stable_sort(in_order.begin(), in_order.end(),
                   [](const ViewDetection* a, const ViewDetection* b) {
                     return std::tie(a->view, a->sweep_utime, a->seq) <
                            std::tie(b->view, b->sweep_utime, b->seq);
                   });
  const bool seen_whole = IsSeenWhole(detections);
  for (const ViewDetection* detection : in_order) {
    CameraView& view = views.all.emplace_back(CameraViewOf(camera.name, *detection));
    RejectEmpty(camera, &view);
    if (seen_whole || !view.usable() || view.image->picked || SeesAllCorners(*view.image)) continue;
    view.Reject(
        "a part of the board lies outside the image, and no view shows it whole: a board of "
        "another size would look the same. Take a view with all of the board in the image");
  }
  RejectCopies(&views.all);
  return views;
}

CameraViews PosedAgain(CameraViews camera, const Lens& lens, const Target& target,
                       const Eigen::Vector3d& bow_m) {
  CameraSpec spec = *camera.spec;
  spec.lens = lens;
  const Camera by_lens(spec), by_given(*camera.spec);
  for (CameraView& view : camera.all) {
    if (!view.usable() || !view.image->pose) continue;
    const auto found =
        PoseFromCorners(by_lens, target, view.image->corners, kMostCornersOff, bow_m);
    if (!found) continue;
    auto edges = std::make_shared<ImageEdges>(*view.image);
    const bool half_turn_known = edges->pose->half_turn_known;
    edges->pose = found->pose;
    edges->pose->half_turn_known = half_turn_known;
    edges->corner_sigma_px = found->inflation * found->corner_sigma_px;
    auto outline = OutlineAt(by_lens, target, edges->pose->sensor_from_target);
    const auto given =
        PoseFromCorners(by_given, target, view.image->corners, kMostCornersOff, bow_m);
    const bool apart =
        !given || AreApart(OutlineAt(by_given, target, given->pose.sensor_from_target), outline);
    if (apart && !outline.empty()) edges->outline = std::move(outline);
    view.image = edges.get();
    camera.posed_again.push_back(std::move(edges));
  }
  return camera;
}

}  // namespace rgbdt
