#include "viewer/live/mount_history.h"

#include <cmath>
#include <utility>
#include <vector>

namespace rgbdt::viewer {
namespace {

constexpr double kDegreesPerRadian = 180 / M_PI;

const char* NameOf(MountState state) {
  switch (state) {
    case MountState::kHolds:
      return "holds";
    case MountState::kMoved:
      return "moved";
    case MountState::kLost:
      return "lost";
    case MountState::kCannotTell:
      break;
  }
  return "cannot_tell";
}

}  // namespace

void MountHistory::Add(const MountCheck& check) {
  if (cameras_.size() >= kMostCameras && cameras_.count(check.camera) == 0) return;
  Camera& camera = cameras_[check.camera];
  if (!camera.steps.empty() && check.utime < camera.steps.back().utime) camera.steps.clear();
  camera.newest = check;
  if (!check.holds) return;  // nothing was told
  camera.steps.push_back({check.utime, check.moved.head<3>().norm() * kDegreesPerRadian});
  if (camera.steps.size() > kKept) camera.steps.pop_front();
}

nlohmann::json MountHistory::Frame() const {
  nlohmann::json cameras = nlohmann::json::array();
  for (const auto& [name, camera] : cameras_) {
    nlohmann::json steps = nlohmann::json::array();
    for (const Step& step : camera.steps) {
      steps.push_back({{"utime", step.utime}, {"rotation_deg", step.rotation_deg}});
    }
    nlohmann::json one = {{"camera", name},
                          {"state", NameOf(camera.newest.state)},
                          {"holds", nullptr},
                          {"text", camera.newest.text},
                          {"utime", camera.newest.utime},
                          {"where", camera.newest.where},
                          {"steps", std::move(steps)}};
    if (camera.newest.holds) one["holds"] = *camera.newest.holds;
    cameras.push_back(std::move(one));
  }
  return {{"type", "mounts"}, {"cameras", std::move(cameras)}};
}

}  // namespace rgbdt::viewer
