#include "tests/browser/true_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/hidden_outline.h"
#include "calib/simulate/internal/lens_table.h"

namespace rgbdt::browser {
namespace {

using simulate::Hit;

const simulate::CameraOptions& CameraOf(const simulate::Options& options, const std::string& name) {
  for (const simulate::CameraOptions& camera : options.cameras) {
    if (camera.name == name) return camera;
  }
  throw InputError("the simulated rig has no camera \"" + name + "\"");
}

}  // namespace

TrueScene::TrueScene(const simulate::Options& options, const std::filesystem::path& truth,
                     const std::string& view)
    : options_(options), truth_(ReadTruth(truth)) {
  const auto pose = truth_.lidar_from_target.find(view);
  if (pose == truth_.lidar_from_target.end()) {
    throw InputError(truth.string() + " has no view \"" + view + "\"");
  }
  lidar_from_target_ = pose->second;
  const auto scene = std::make_shared<const simulate::SceneModel>(simulate::MakeScene(options));
  const simulate::HeatMap heat =
      simulate::DrawHeat(options.board, scene->board_heat, options.seed, std::stoi(view) - 1);
  world_.emplace(scene, simulate::Board(options.board, lidar_from_target_, heat), options);
  const Eigen::Vector3d eye = truth_.camera_from_lidar.at("thermal").Inverse().translation;
  world_->set_heat(simulate::HideOutline(*world_, eye, options.board));
}

std::vector<Eigen::Vector3d> TrueScene::Squares() const {
  const Target target = simulate::MakeTarget(options_.board);
  std::vector<Eigen::Vector3d> squares;
  for (const int row : {1, 4, 6}) {
    for (const int column : {2, 5, 8}) {
      const Eigen::Vector3d place((column + 0.5 - 0.5 * target.squares_x) * target.square_m,
                                  (row + 0.5 - 0.5 * target.squares_y) * target.square_m, 0);
      squares.push_back(lidar_from_target_ * place);
    }
  }
  return squares;
}

std::array<Eigen::Vector2d, 4> TrueScene::OutlineIn(const std::string& camera) const {
  const simulate::CameraOptions& options = CameraOf(options_, camera);
  const simulate::LensTable lens(options.lens, options.width, options.height);
  const Rigid3 camera_from_target = truth_.camera_from_lidar.at(camera) * lidar_from_target_;
  std::array<Eigen::Vector2d, 4> pixels;
  const auto corners = simulate::MakeTarget(options_.board).OutlineCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = lens.Project(camera_from_target * corners[i]);
    if (!pixel) throw InputError("camera " + camera + " does not see the board");
    pixels[i] = *pixel;
  }
  return pixels;
}

// A beam's origin goes round with the motor, some centimetres off the axis: what the point says of
// its direction is enough to find the motor's angle.
TruePoint TrueScene::At(const Eigen::Vector3d& point) const {
  const double angle = std::atan2(point.y(), point.x());
  const Eigen::Vector3d origin =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * options_.scanner.lever_arm_m;
  const Eigen::Vector3d ray = (point - origin).normalized();
  const Hit hit = world_->caster().Cast(origin, ray);
  TruePoint found;
  if (!hit.hit()) return found;
  const Eigen::Vector3d place = origin + hit.range * ray;
  found.distance_m = (point - place).norm();
  found.what = world_->IsBoard(hit) ? "board" : world_->Object(hit).name;
  found.kelvin = SeenAround(place);
  return found;
}

// What the thermal camera's blur (1 px), its sampling (half a pixel) and the beam's width (half of
// 2.7 mrad) mix: all surfaces within 3 mrad of the place.
Temperatures TrueScene::SeenAround(const Eigen::Vector3d& place) const {
  constexpr double kRound = 0.003;
  const Eigen::Vector3d eye = truth_.camera_from_lidar.at("thermal").Inverse().translation;
  const Eigen::Vector3d ray = (place - eye).normalized();
  const Eigen::Vector3d a = ray.unitOrthogonal();
  const Eigen::Vector3d b = ray.cross(a);
  Temperatures range{1e9, 0};
  for (const double away : {0.0, 0.5 * kRound, kRound}) {
    for (int k = 0; k < 12; ++k) {
      const double turn = k * M_PI / 6;
      const Eigen::Vector3d beside =
          (ray + away * (std::cos(turn) * a + std::sin(turn) * b)).normalized();
      const Hit hit = world_->caster().Cast(eye, beside);
      if (!hit.hit()) continue;
      const double kelvin = world_->At(hit, eye + hit.range * beside, 0).material.temperature_k;
      range.low = std::min(range.low, kelvin);
      range.high = std::max(range.high, kelvin);
    }
  }
  return range;
}

}  // namespace rgbdt::browser
