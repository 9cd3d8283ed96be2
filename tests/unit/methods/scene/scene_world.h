#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/shot.h"
#include "calib/simulate/simulator.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {

/// The synthetic rig's outdoor scene, small: a colour camera of a quarter of
/// the resolution, a thermal one of half, and a spinning
/// LIDAR that resolves half a degree by three quarters.
inline simulate::Options SmallScene() {
  simulate::Options options;
  for (simulate::CameraOptions& camera : options.cameras) {
    const int part = camera.kind == CameraKind::kColor ? 4 : 2;
    camera.width /= part;
    camera.height /= part;
    camera.lens.fx /= part;
    camera.lens.fy /= part;
    camera.lens.cx = (camera.lens.cx + 0.5) / part - 0.5;
    camera.lens.cy = (camera.lens.cy + 0.5) / part - 0.5;
  }
  options.supersampling = 3;
  simulate::UseLidar(32, &options);
  options.spinning->elevations_rad.clear();
  for (double e = -24; e <= 24; e += 0.75) {
    options.spinning->elevations_rad.push_back(e * simulate::kDegree);
  }
  options.spinning->azimuth_step_rad = 0.5 * simulate::kDegree;
  return options;
}

/// Sweeps and images of it, the board elsewhere in each.
class SceneWorld {
 public:
  explicit SceneWorld(int views, const simulate::Options& options = SmallScene())
      : simulator_(options) {
    for (int i = 0; i < views; ++i) {
      const Utime utime = 1000000000 + 1000000 * static_cast<Utime>(i);
      simulator_.ShowView(i, std::to_string(i));
      clouds.push_back(simulator_.Revolution(utime));
      for (const CameraSpec& camera : rig().cameras) {
        images.push_back(simulator_.TakeImage(camera.name, utime));
      }
    }
  }

  const Rig& rig() const { return simulator_.rig(); }
  const Rigid3& Truth(std::size_t camera) const {
    return simulator_.truth().camera_from_lidar.at(rig().cameras[camera].name);
  }
  std::vector<Shot> Shots(std::size_t camera) const {
    std::vector<Shot> shots;
    for (std::size_t v = 0; v < clouds.size(); ++v) {
      shots.push_back({std::to_string(v), &clouds[v], &images[v * rig().cameras.size() + camera]});
    }
    return shots;
  }

  std::vector<Cloud> clouds;
  std::vector<Image> images;  ///< of each view by the rig's cameras in turn

 private:
  simulate::Simulator simulator_;
};

/// The pose turned by 2 degrees about each of its axes, either way.
inline std::vector<Rigid3> TurnedTwoDegrees(const Rigid3& pose) {
  std::vector<Rigid3> turned;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {-2 * simulate::kDegree, 2 * simulate::kDegree}) {
      turned.push_back(RotationAbout(Eigen::Vector3d::Unit(axis), angle) * pose);
    }
  }
  return turned;
}

/// A camera that looks away from all that the LIDAR sees: the cloud's points behind it.
inline Rigid3 LookingAway(const Rigid3& pose) {
  return RotationAbout(Eigen::Vector3d::UnitX(), 90 * simulate::kDegree) * pose;
}

}  // namespace rgbdt
