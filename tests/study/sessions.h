#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/view_detection.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

/// What a session is like.
struct SessionOptions {
  int views = 5;
  int rings = 0;         ///< of the LIDAR; 0: the turned scanner
  bool clutter = false;  ///< with a door, a poster, a table, a panel and a second board,
                         ///< the board held by a stand, a person or an easel
  int wrong_clouds = 0;  ///< of so many views the cloud is not theirs: another view's, or no board
};

/// What camera and LIDAR make of a board, and where it is.
struct SessionView {
  ViewDetection detection;   ///< of the one camera
  Rigid3 lidar_from_target;  ///< of the board that the camera saw
  bool wrong_cloud = false;
};

struct Session {
  CameraKind kind = CameraKind::kColor;
  std::string holder;        ///< of the board: "stand", "person" or "easel"
  Rigid3 camera_from_lidar;  ///< the truth
  std::vector<SessionView> views;
};

/// Clouds are rendered, corners sampled (see CornerSigma); boards are found by the library. The
/// camera is turned about its axis by any angle, and the LIDAR stands in any orientation: together
/// camera_from_lidar is spread over the whole sphere of rotations. Nothing where the scene that
/// this seed draws has no room.
std::optional<Session> MakeSession(const SessionOptions& options, std::uint64_t seed);

}  // namespace rgbdt::study
