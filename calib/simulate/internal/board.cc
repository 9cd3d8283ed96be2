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

namespace {

// Which column (or row) of a pattern a place is in, measured from the pattern's middle [m]; -1:
// beside. `edge_at`: where each begins.
template <typename EdgeAt>
double ColumnAt(const EdgeAt& edge_at, int columns, double from_middle) {
  const double at = from_middle + 0.5 * edge_at(columns);
  for (int column = 0; column < columns; ++column) {
    if (at >= edge_at(column) && at < edge_at(column + 1)) return column;
  }
  return -1;
}

}  // namespace

Board::Board(const BoardOptions& options, const Rigid3& lidar_from_target, const HeatMap& heat)
    : options_(options),
      target_(MakeTarget(options)),
      lidar_from_target_(lidar_from_target),
      target_from_lidar_(lidar_from_target.Inverse()),
      heat_(heat) {
  if (!options.markers) return;
  bits_ = std::make_shared<const MarkerBits>(*options.markers);
  marker_in_.resize(static_cast<std::size_t>(options.squares_x * options.squares_y));
  for (const MarkerPlace& place : target_.MarkerPlaces()) {
    const int square = Patch(place.centre.cwiseProduct(options.print_scale)) - 1;
    marker_in_[static_cast<std::size_t>(square)] = place;
  }
}

Mesh Board::Shape() const {
  const double x = 0.5 * options_.width_m;
  const double y = 0.5 * options_.height_m;
  const double depth = options_.thickness_m;
  if (!options_.holes) return Transformed(lidar_from_target_, MakeBox({-x, -y, 0}, {x, y, depth}));
  Mesh shape;
  for (const Eigen::Vector2d& hole : target_.HoleCentres()) {  // each in a quarter of the board
    const Eigen::Vector2d to(hole.x() < 0 ? -x : x, hole.y() < 0 ? -y : y);
    const Eigen::Vector2d low = to.cwiseMin(0);
    const Eigen::Vector2d high = to.cwiseMax(0);
    Add(MakePlateWithHole({low.x(), low.y(), 0}, {high.x(), high.y(), depth}, hole,
                          options_.holes->radius_m),
        &shape);
  }
  return Transformed(lidar_from_target_, std::move(shape));
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
  double x = place.x() / square.x() + 0.5 * options_.squares_x;
  double y = place.y() / square.y() + 0.5 * options_.squares_y;
  if (options_.markers && options_.markers->grid()) {
    x = ColumnAt([&](int column) { return target_.ColumnEdge(column); }, options_.squares_x,
                 place.x() / options_.print_scale.x());
    y = ColumnAt([&](int row) { return target_.RowEdge(row); }, options_.squares_y,
                 place.y() / options_.print_scale.y());
  }
  if (x < 0 || y < 0 || x >= options_.squares_x || y >= options_.squares_y) return 0;
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const int square_number = 1 + row * options_.squares_x + column;
  const auto cell = CellOf(place, column, row);
  return cell ? 1 + options_.squares_x * options_.squares_y + *cell : square_number;
}

std::optional<int> Board::CellOf(const Eigen::Vector2d& place, int column, int row) const {
  if (marker_in_.empty()) return std::nullopt;
  const int square = row * options_.squares_x + column;
  const auto& marker = marker_in_[static_cast<std::size_t>(square)];
  if (!marker) return std::nullopt;
  const int cells = bits_->cells();
  const Eigen::Vector2d at = place.cwiseQuotient(options_.print_scale) - marker->centre;
  const Eigen::Vector2d in_cells = (at / options_.markers->side_m).array() * cells + 0.5 * cells;
  if ((in_cells.array() < 0).any() || (in_cells.array() >= cells).any()) return std::nullopt;
  const int x = static_cast<int>(in_cells.x());
  const int y = static_cast<int>(in_cells.y());
  if (bits_->IsWhite(marker->id, x, y) != target_.IsBlack(column, row)) return std::nullopt;
  return (square * cells + y) * cells + x;
}

bool Board::IsBlack(int patch) const {
  if (patch <= 0) return !options_.holes;
  // Cells that differ from their square: black in ChArUco's white ones, white in a grid's black.
  if (patch > options_.squares_x * options_.squares_y) return !options_.markers->grid();
  return target_.IsBlack((patch - 1) % options_.squares_x, (patch - 1) / options_.squares_x);
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
  const bool border = *patch == 0 && !options_.holes;
  material.temperature_k = border ? heat_.BorderAt(p.head<2>()) : heat_.At(p.head<2>(), black);
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
  target.markers = options.markers;
  target.holes = options.holes;
  return target;
}

}  // namespace rgbdt::simulate
