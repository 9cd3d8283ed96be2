#pragma once

#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/simulate/simulator.h"
#include "calib/simulate/use_target.h"
#include "tests/unit/detect/image/covered_board.h"

namespace rgbdt {

/// A rendered colour image of a board with markers.
struct MarkedScene {
  CameraSpec spec;
  Target target;
  Image image;
  Rigid3 camera_from_target;
  std::vector<Eigen::Vector2d> corners;  ///< true places of the inner corners [px]

  cv::Mat grey() const { return ToGrey(image); }
};

/// ChArUco of 11x8 squares of 100 mm, markers of 75 mm, on the usual board.
inline simulate::BoardOptions CharucoBoard() {
  simulate::BoardOptions board;
  board.markers = Markers{"5X5_100", 0.075, 1, 0, false};
  return board;
}

/// 7x5 AprilTags of 130 mm, a quarter of that apart, on the usual board.
inline simulate::BoardOptions AprilGridBoard() {
  simulate::BoardOptions board;
  board.markers = Markers{"APRILTAG_36h11", 0.13, kKalibrBorderBits, 0.0325, false};
  const Target grid = GridOfMarkers(7, 5, *board.markers);
  board.squares_x = grid.squares_x;
  board.squares_y = grid.squares_y;
  board.square_m = grid.square_m;
  return board;
}

/// Four holes and as many markers: velo2cam's and FAST-Calib's, markers with a white rim.
inline simulate::BoardOptions HolesBoard() {
  simulate::BoardOptions board;
  simulate::UseTarget(BoardWithHoles(Markers{kHolesFamily, 0.16, 1, 0, false}), &board);
  return board;
}

/// By one of the usual cameras: 0 colour, 1 thermal.
inline MarkedScene RenderMarked(const simulate::BoardOptions& board, std::uint64_t seed,
                                std::size_t camera_index = 0) {
  simulate::Options options;
  options.seed = seed;
  options.cameras = {options.cameras[camera_index]};
  options.board = board;
  simulate::Simulator simulator(options);
  simulator.ShowView(0, "0001");
  MarkedScene scene;
  scene.spec = simulator.rig().cameras.front();
  scene.target = simulator.rig().target;
  scene.image = simulator.TakeImage(scene.spec.name, 1'000'000);
  scene.camera_from_target = simulator.truth().camera_from_lidar.at(scene.spec.name) *
                             simulator.truth().lidar_from_target.at("0001");
  const Camera camera(scene.spec);
  for (const Eigen::Vector3d& corner : scene.target.InnerCorners()) {
    scene.corners.push_back(*camera.Project(scene.camera_from_target * corner));
  }
  return scene;
}

/// Hides 40% of the board, from its left, behind something of its own brightness.
inline void HideTwoFifths(std::uint64_t seed, MarkedScene* scene) {
  Random random(seed);
  scene->image.pixels = scene->image.pixels.clone();  // a copy of the scene has the same
  PaintCover(Camera(scene->spec), scene->target, scene->camera_from_target, Cover::kHalf, -0.1,
             &random, &scene->image.pixels);
}

}  // namespace rgbdt
