#include "viewer/live/live_overlays.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "calib/present/frames/overlay_frame.h"
#include "calib/present/layout/frame.h"

namespace rgbdt::viewer {

void LiveOverlays::Add(const TargetStatus& status, double now_s) {
  constexpr std::size_t kMostSensors = 33;
  if (seen_.size() >= kMostSensors && seen_.count(status.camera) == 0) seen_.clear();
  seen_[status.camera] = {status, now_s};
}

Post LiveOverlays::TargetStatusPost(const Rig* rig, double now_s) const {
  nlohmann::json sensors = nlohmann::json::array();
  for (const auto& [camera, seen] : seen_) {
    std::string kind = "lidar";
    if (!camera.empty() && rig != nullptr) {
      kind = rig->Camera(camera).kind == CameraKind::kColor ? "color" : "thermal";
    }
    sensors.push_back({{"sensor", camera.empty() ? "lidar" : camera},
                       {"kind", kind},
                       {"seen", seen.status.seen},
                       {"text", seen.status.text},
                       {"utime", seen.status.utime},
                       {"age_s", now_s - seen.at_s}});
  }
  const nlohmann::json frame = {{"type", "target_status"}, {"sensors", sensors}};
  return {"target_status", "", true, false, 0, [frame] { return JsonFrame(frame); }};
}

Post LiveOverlays::OverlayPost(const CameraSpec& camera, const Calibration& calibration,
                               const FusedPosts::Points& sweep) const {
  const CameraCalibration* known = calibration.Find(camera.name);
  Overlay overlay;
  overlay.camera = camera.name;
  overlay.calibrated = known != nullptr;
  if (const auto seen = seen_.find(camera.name); seen != seen_.end()) {
    const TargetStatus& status = seen->second.status;
    overlay.utime = status.utime;
    overlay.text = (status.seen ? "board seen, " : "") + status.text;
    overlay.corners = status.corners;
    overlay.outline = status.outline;
  }
  std::optional<Rigid3> camera_from_lidar;
  if (known != nullptr) camera_from_lidar = known->camera_from_lidar;
  Post post;
  post.topic = "overlay/" + camera.name;
  post.watch = "camera/" + camera.name;
  post.heavy = true;
  post.make = [overlay, spec = calibration.WithSolvedLens(camera), camera_from_lidar,
               sweep]() mutable {
    if (camera_from_lidar && sweep) overlay.cloud = LayOnImage(spec, *camera_from_lidar, *sweep);
    return OverlayFrame(overlay, true);
  };
  return post;
}

}  // namespace rgbdt::viewer
