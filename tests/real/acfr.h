#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/detect_view.h"

namespace rgbdt {

namespace fs = std::filesystem;

/// point_in_lidar = R point_in_camera + t, R = Rz(yaw) Ry(pitch) Rx(roll): README of the data.
inline Rigid3 PublishedCameraFromLidar() {
  const Rigid3 rotation = RotationAbout({0, 0, 1}, -1.4929) * RotationAbout({0, 1, 0}, -0.0209) *
                          RotationAbout({1, 0, 0}, -1.695);
  return Rigid3{rotation.rotation, {0.063, 0.004, -0.196}}.Inverse();
}

struct Detected {
  Session session;
  std::vector<ViewDetection> views;
};

/// Nothing where the data is absent. `views`: what was read, too.
inline std::optional<Detected> DetectReal(const std::string& method,
                                          const std::string& folder = "acfr_vlp16",
                                          std::vector<View>* views = nullptr) {
  const char* real = std::getenv("RGBDT_REAL_DATA");
  const fs::path source = fs::path(real == nullptr ? "" : real) / folder;
  if (real == nullptr || !fs::exists(source)) return std::nullopt;
  const fs::path dir = fs::path(::testing::TempDir()) /
                       ("rgbdt_acfr_" + method + "_" +
                        ::testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::remove_all(dir);
  const std::string command = std::string(RGBDT_SOURCE_DIR) + "/scripts/session-from-acfr '" +
                              source.string() + "' '" + dir.string() + "' > /dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command + " failed");
  Detected detected{OpenSession(dir), {}};
  for (const std::string& view : detected.session.views) {
    View read = ReadView(detected.session, view);
    detected.views.push_back(DetectView(detected.session.rig, read, method));
    if (views != nullptr) views->push_back(std::move(read));
  }
  fs::remove_all(dir);
  return detected;
}

inline constexpr const char* kAbsent = "RGBDT_REAL_DATA is not set, or has no acfr_vlp16";

}  // namespace rgbdt
