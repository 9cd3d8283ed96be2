#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/mount_check.h"

namespace rgbdt::viewer {

/// What the monitor said of each camera's mount, newest and before: a lamp and a chart.
class MountHistory {
 public:
  static constexpr std::size_t kKept = 600;  ///< of a camera, the newest
  static constexpr std::size_t kMostCameras = 32;

  /// One older than the camera's newest means that the clock was set back: its history goes.
  void Add(const MountCheck& check);
  void Clear() { cameras_.clear(); }

  /// A MountsFrame (page/src/protocol.ts).
  nlohmann::json Frame() const;

 private:
  struct Step {
    Utime utime = 0;
    double rotation_deg = 0;
  };
  struct Camera {
    MountCheck newest;
    std::deque<Step> steps;
  };
  std::map<std::string, Camera> cameras_;
};

}  // namespace rgbdt::viewer
