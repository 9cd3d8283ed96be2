#include "calib/simulate/internal/board.h"

#include <algorithm>
#include <cmath>

#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {

double HeatMap::BorderAt(const Eigen::Vector2d& place) const {
  return border_k.value_or(Between(place, border_to_white));
}

double HeatMap::Between(const Eigen::Vector2d& place, double whiteness) const {
  const double glow = (place - glow_centre).squaredNorm() / (2 * glow_radius_m * glow_radius_m);
  double temperature = mean_k + slope_k_per_m.dot(place) + glow_k * std::exp(-glow);
  if (hides) {
    // The border is black: shift the mean so that black meets the background's temperature there.
    const Eigen::Vector2d offset = place - hidden_centre;
    const double along = std::max(0.0, std::abs(offset.dot(hidden_along)) - hidden_half_m);
    const double across = offset.x() * hidden_along.y() - offset.y() * hidden_along.x();
    // Flat for half the depth, so that the border itself has the temperature in full.
    const double deep = std::max(0.0, std::abs(across) - 0.5 * hidden_depth_m);
    const double weight =
        std::exp(-(along * along + deep * deep) / (2 * hidden_depth_m * hidden_depth_m));
    temperature += weight * (hidden_k - 0.5 * black_minus_white_k - temperature);
  }
  return temperature + (0.5 - whiteness) * black_minus_white_k;
}

Board::Board(const BoardOptions& options, const Rigid3& lidar_from_target, const HeatMap& heat)
    : options_(options),
      lidar_from_target_(lidar_from_target),
      target_from_lidar_(lidar_from_target.Inverse()),
      heat_(heat) {}

Mesh Board::Shape() const {
  const double x = 0.5 * options_.width_m;
  const double y = 0.5 * options_.height_m;
  return Transformed(lidar_from_target_, MakeBox({-x, -y, 0}, {x, y, options_.thickness_m}));
}

std::vector<Mesh> Board::Stand(double ground_z) const {
  // The pole is vertical: far enough behind that a board leaning either way does not touch it.
  const Eigen::Vector3d back = lidar_from_target_ * Eigen::Vector3d(0, 0, options_.thickness_m);
  const Eigen::Vector3d away = lidar_from_target_.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d flat = Eigen::Vector3d(away.x(), away.y(), 0).normalized();
  double deepest = 0;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Eigen::Vector3d corner =
          lidar_from_target_.rotation *
          Eigen::Vector3d(x * options_.width_m, y * options_.height_m, 0);
      deepest = std::max(deepest, corner.dot(flat));
    }
  }
  const double half = 0.5 * options_.stand_m;
  const Eigen::Vector3d top = back + (deepest + 2 * options_.stand_m) * flat;
  const Eigen::Vector3d foot(top.x(), top.y(), ground_z);
  return {MakeRod(back, top, half, half),
          MakeBox({foot.x() - half, foot.y() - half, ground_z},
                  {foot.x() + half, foot.y() + half, top.z() + half}),
          MakeRod(foot, foot + Eigen::Vector3d(0, 0, 0.04), 0.22, 0.2)};
}

int Board::Patch(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d square = options_.square_m * options_.print_scale;
  const double x = place.x() / square.x() + 0.5 * options_.squares_x;
  const double y = place.y() / square.y() + 0.5 * options_.squares_y;
  if (x < 0 || y < 0 || x >= options_.squares_x || y >= options_.squares_y) return 0;
  return 1 + static_cast<int>(y) * options_.squares_x + static_cast<int>(x);
}

bool Board::IsBlack(int patch) const {
  if (patch <= 0) return true;
  const int column = (patch - 1) % options_.squares_x;
  const int row = (patch - 1) / options_.squares_x;
  return (column + row) % 2 == 0;
}

int Board::PatchOf(const Eigen::Vector3d& p) const {
  const bool front = std::abs(p.z()) < 1e-4 && std::abs(p.x()) < 0.5 * options_.width_m - 1e-5 &&
                     std::abs(p.y()) < 0.5 * options_.height_m - 1e-5;
  return front ? Patch(p.head<2>()) : -1;
}

double Board::Reflectivity(const Eigen::Vector3d& point_in_lidar) const {
  const bool black = IsBlack(PatchOf(target_from_lidar_ * point_in_lidar));
  return black ? options_.black_reflectivity : options_.white_reflectivity;
}

Material Board::At(const Eigen::Vector3d& point_in_lidar, int* patch) const {
  const Eigen::Vector3d p = target_from_lidar_ * point_in_lidar;
  *patch = PatchOf(p);
  const bool black = IsBlack(*patch);
  Material material;
  material.reflectivity = black ? options_.black_reflectivity : options_.white_reflectivity;
  material.albedo.setConstant(material.reflectivity);
  material.emissivity = options_.emissivity;
  material.temperature_k = *patch == 0 ? heat_.BorderAt(p.head<2>()) : heat_.At(p.head<2>(), black);
  return material;
}

HeatMap DrawHeat(const BoardOptions& options, const BoardHeat& scene, std::uint64_t seed,
                 int index) {
  const Noise noise(seed, index, "heat");
  const double angle = noise.Uniform(0, 0, 2 * 3.14159265358979323846);
  HeatMap heat;
  heat.mean_k = options.temperature_k.value_or(scene.temperature_k);
  heat.black_minus_white_k = options.black_minus_white_k.value_or(scene.black_minus_white_k);
  heat.slope_k_per_m = options.gradient_k.value_or(scene.gradient_k) / options.width_m *
                       Eigen::Vector2d(std::cos(angle), std::sin(angle));
  heat.glow_centre = {noise.Uniform(1, -0.35, 0.35) * options.width_m,
                      noise.Uniform(2, -0.35, 0.35) * options.height_m};
  heat.glow_k = options.glow_k.value_or(scene.glow_k);
  heat.glow_radius_m = options.glow_radius_m;
  heat.border_k = options.border_k;
  heat.border_to_white = options.border_to_white;
  return heat;
}

Target MakeTarget(const BoardOptions& options) {
  Target target;
  target.squares_x = options.squares_x;
  target.squares_y = options.squares_y;
  target.square_m = options.square_m;
  target.width_m = options.width_m;
  target.height_m = options.height_m;
  target.print_sigma = options.print_sigma;
  return target;
}

}  // namespace rgbdt::simulate
