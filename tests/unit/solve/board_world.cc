#include "tests/unit/solve/board_world.h"

#include <cmath>
#include <set>
#include <utility>

#include "calib/camera/camera.h"

namespace rgbdt {

std::vector<CameraView> BoardWorld::Used() const {
  std::vector<CameraView> used;
  for (const ViewDetection& detection : views) {
    if (!detection.heldout) used.push_back(CameraViewOf(spec.name, detection));
  }
  return used;
}

std::vector<const CameraView*> PointersTo(const std::vector<CameraView>& views) {
  std::vector<const CameraView*> pointers;
  for (const CameraView& view : views) pointers.push_back(&view);
  return pointers;
}

CameraSpec WorldCamera() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 640;
  spec.height = 480;
  spec.lens = {Lens::Model::kPinhole, 500, 501, 318.3, 241.2, {-0.15, 0.05, 3e-4, -2e-4}};
  return spec;
}

Rigid3 WorldTruth() {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Rigid3 truth = RotationAbout({0.3, -0.5, 0.8}, 0.06);
  truth.rotation = truth.rotation * Eigen::Quaterniond(axes);
  truth.translation = {0.08, -0.12, 0.05};
  return truth;
}

ViewDetection DetectBoard(const CameraSpec& spec, const Rigid3& camera_from_lidar,
                          const Rigid3& lidar_from_board, const std::string& view) {
  constexpr double kHalfWidth = 0.6;
  constexpr double kHalfHeight = 0.45;
  const Eigen::Vector3d corners[] = {{-kHalfWidth, -kHalfHeight, 0},
                                     {kHalfWidth, -kHalfHeight, 0},
                                     {kHalfWidth, kHalfHeight, 0},
                                     {-kHalfWidth, kHalfHeight, 0}};
  const Camera camera(spec);
  ImageEdges image;
  image.width = spec.width;
  image.height = spec.height;
  CloudEdges cloud;
  std::set<std::pair<int, int>> pixels;  // by row, each once
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector3d from = lidar_from_board * corners[side];
    const Eigen::Vector3d to = lidar_from_board * corners[(side + 1) % 4];
    for (const Eigen::Vector2d& p :
         ProjectSegment(camera, camera_from_lidar * from, camera_from_lidar * to, 2000)) {
      pixels.insert({std::lround(p.y()), std::lround(p.x())});
      image.outline.push_back(p);
    }
    constexpr int kPoints = 40;  // 2 to 3 cm apart
    for (int i = 0; i < kPoints; ++i) {
      cloud.boundary.emplace_back(from + (to - from) * (static_cast<double>(i) / kPoints));
    }
  }
  for (const auto& [y, x] : pixels) image.edge_pixels.emplace_back(x, y);
  ViewDetection detection;
  detection.view = view;
  detection.images = {{spec.name, 0, std::move(image), "", 0}};
  detection.cloud.candidates = {std::move(cloud)};
  return detection;
}

BoardWorld MakeBoardWorld(int count, std::uint32_t seed) {
  BoardWorld world{WorldCamera(), WorldTruth(), {}};
  const Camera camera(world.spec);
  Random random(seed);
  while (static_cast<int>(world.views.size()) < count) {
    Rigid3 camera_from_board = RotationAbout(random.Direction(), random.Uniform(0.2, 0.7)) *
                               RotationAbout({0, 0, 1}, random.Uniform(-0.8, 0.8));
    const double z = random.Uniform(2, 4.5);
    camera_from_board.translation = {random.Uniform(-0.5, 0.5) * z, random.Uniform(-0.4, 0.4) * z,
                                     z};
    const auto n = world.views.size();
    ViewDetection detection =
        DetectBoard(world.spec, world.camera_from_lidar,
                    world.camera_from_lidar.Inverse() * camera_from_board, std::to_string(n));
    const std::vector<Eigen::Vector2d>& outline = detection.images[0].edges->outline;
    bool whole = outline.size() == 4 * 2001;
    for (const Eigen::Vector2d& p : outline) whole &= camera.Contains(p);
    if (!whole) continue;
    detection.heldout = n % 3 == 2;
    detection.images[0].utime = static_cast<Utime>(1000 + n);
    world.views.push_back(std::move(detection));
  }
  return world;
}

Rigid3 GuessOff(const Rigid3& truth, double angle, double shift, std::uint32_t seed) {
  Random random(seed);
  Rigid3 guess = RotationAbout(random.Direction(), angle) * truth;
  guess.translation = guess.rotation * (truth.rotation.conjugate() * truth.translation) +
                      shift * random.Direction();  // the camera's centre moves by `shift` alone
  return guess;
}

}  // namespace rgbdt
