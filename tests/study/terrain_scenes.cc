#include "tests/study/terrain_scenes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/internal/spinning.h"

namespace rgbdt::study {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using simulate::kDegree;
using simulate::SceneModel;

constexpr double kGround = -1.2;  // [m] below the LIDAR
constexpr Utime kTime = 1'700'000'000'000'000;
constexpr int kRays = 8;        // across a square
constexpr double kTop = 30;     // [m] where vertical rays begin
constexpr double kSkin = 1e-5;  // [m] from a surface to where the ray behind it begins

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(static_cast<std::uint32_t>(seed * 7919 + 13)) {}
  double operator()(double from, double to) {
    return from + (to - from) * (engine_() / 4294967296.0);
  }

 private:
  std::mt19937 engine_;
};

/// Level ground, a ramp from `ramp_x` on, higher by `kerb` to the left of `kerb_y`.
struct CourseGround {
  double ramp_x, ramp_slope, kerb_y, kerb;
  double At(double x, double y) const {
    return kGround + std::max(0.0, x - ramp_x) * ramp_slope + (y > kerb_y ? kerb : 0);
  }
};

void AddStrip(const CourseGround& ground, double from_x, double to_x, SceneModel* scene) {
  constexpr double kSide = 40, kEdge = 1e-6;
  const auto add = [&](double low_y, double high_y) {
    const double y = (low_y + high_y) / 2;
    const double near = ground.At(from_x, y), far = ground.At(to_x, y);
    scene->objects.push_back({"ground",
                              simulate::MakeQuad({from_x, low_y, near}, {to_x, low_y, far},
                                                 {to_x, high_y, far}, {from_x, high_y, near}),
                              {}});
  };
  add(-kSide, ground.kerb_y);
  add(ground.kerb_y, kSide);
  const double y = ground.kerb_y;
  const auto corner = [&](double x, double side) {
    return Vector3d(x, y, ground.At(x, y + side * kEdge));
  };
  scene->objects.push_back(
      {"ground",
       simulate::MakeQuad(corner(from_x, -1), corner(to_x, -1), corner(to_x, 1), corner(from_x, 1)),
       {}});
}

void AddTable(double x, double y, double ground, SceneModel* scene) {
  const double top = ground + 0.5;
  scene->objects.push_back(
      {"table", simulate::MakeBox({x - 0.4, y - 0.6, top - 0.04}, {x + 0.4, y + 0.6, top}), {}});
  for (const double dx : {-0.35, 0.35}) {
    for (const double dy : {-0.55, 0.55}) {
      scene->objects.push_back({"leg",
                                simulate::MakeBox({x + dx - 0.03, y + dy - 0.03, ground - 0.05},
                                                  {x + dx + 0.03, y + dy + 0.03, top - 0.04}),
                                {}});
    }
  }
}

std::shared_ptr<SceneModel> MakeCourse(std::uint64_t seed) {
  Dice dice(seed);
  auto scene = std::make_shared<SceneModel>();
  const CourseGround ground{dice(3, 5), std::tan(dice(6, 12) * kDegree), dice(0.8, 2.2), 0.15};
  AddStrip(ground, -40, ground.ramp_x, scene.get());
  AddStrip(ground, ground.ramp_x, 40, scene.get());
  for (int i = 0; i < 7; ++i) {
    const double x = dice(3, 10), y = x * dice(-0.5, 0.5), half = dice(0.15, 0.5);
    const double low = std::min(ground.At(x - half, y - half), ground.At(x - half, y + half));
    const double top = ground.At(x, y + half) + dice(0.15, 1.0);
    scene->objects.push_back(
        {"box", simulate::MakeBox({x - half, y - half, low - 0.1}, {x + half, y + half, top}), {}});
  }
  for (int i = 0; i < 3; ++i) {
    const double x = dice(3, 9), y = x * dice(-0.5, 0.5);
    scene->objects.push_back(
        {"post",
         simulate::MakeRod({x, y, ground.At(x, y) - 0.2}, {x, y, ground.At(x, y) + 2}, 0.06, 0.06),
         {}});
  }
  const double table_x = dice(3, 6), table_y = -dice(0.5, 1.5);
  AddTable(table_x, table_y, ground.At(table_x, table_y), scene.get());
  const double beam_x = dice(5, 7);
  const double beam = ground.At(beam_x, 40) + 3;
  scene->objects.push_back(
      {"beam", simulate::MakeBox({beam_x, -4, beam}, {beam_x + 0.3, 4, beam + 0.2}), {}});
  return scene;
}

simulate::Options OptionsFor(const TerrainCase& which) {
  simulate::Options options;
  // Outdoors and night are one yard: other clutter, other noise.
  options.seed = which.seed + (which.scene == TerrainScene::kNight ? 100'000 : 0);
  options.scanner.range_sigma_m = which.range_sigma_m;
  options.scanner.sweep_start_rad = -45 * kDegree;
  options.scanner.sweep_rad = 90 * kDegree;
  options.scene = which.scene == TerrainScene::kIndoor  ? simulate::Scene::kIndoor
                  : which.scene == TerrainScene::kNight ? simulate::Scene::kNight
                                                        : simulate::Scene::kOutdoor;
  options.clutter.table = true;
  options.clutter.panel = which.seed % 2 == 0;
  options.clutter.poster = which.seed % 3 == 0;
  return options;
}

MapCloud CloudOf(const Cloud& sweep, const Vector2d& shift) {
  MapCloud cloud;
  cloud.frame = "lidar";
  for (const Eigen::Vector3f& point : sweep.points) {
    if (!point.allFinite()) continue;
    cloud.points.push_back(point);
    cloud.points.back().head<2>() += shift.cast<float>();
  }
  return cloud;
}

}  // namespace

std::string NameOf(const TerrainCase& which) {
  static const std::map<TerrainScene, std::string> names = {{TerrainScene::kOutdoor, "outdoor"},
                                                            {TerrainScene::kIndoor, "indoor"},
                                                            {TerrainScene::kNight, "night"},
                                                            {TerrainScene::kCourse, "course"}};
  return names.at(which.scene) + (which.rings > 0 ? ":" + std::to_string(which.rings) : "");
}

TerrainWorld::TerrainWorld(const TerrainCase& which) {
  Dice dice(which.seed + (which.scene == TerrainScene::kNight ? 2000 : 1000));
  shift_ = {dice(-0.5, 0.5), dice(-0.5, 0.5)};
  const simulate::Options options = OptionsFor(which);
  std::shared_ptr<const SceneModel> scene =
      which.scene == TerrainScene::kCourse
          ? std::shared_ptr<const SceneModel>(MakeCourse(which.seed))
          : std::make_shared<SceneModel>(simulate::MakeScene(options));
  for (const simulate::SceneObject& object : scene->objects) {
    is_ground_.push_back(object.name == "ground" || object.name == "lawn" ||
                         object.name == "pavement" || object.name == "floor");
  }
  world_ = std::make_unique<simulate::World>(scene, std::nullopt, options);
  if (which.rings > 0) {
    simulate::SpinningOptions spinning = simulate::SpinningLidar(which.rings);
    spinning.range_sigma_m = which.range_sigma_m;
    cloud_ = CloudOf(simulate::SpinningSweep(*world_, spinning, which.seed, kTime), shift_);
  } else {
    const simulate::Scanner scanner(options.scanner, which.seed);
    cloud_ = CloudOf(scanner.Sweep(*world_, kTime, 0), shift_);
  }
}

struct TerrainWorld::Column {
  struct Solid {
    double low, high;
  };
  std::optional<double> ground;
  std::vector<Solid> solids;  // a sheet has no thickness
};

TerrainWorld::Column TerrainWorld::Look(double x, double y) const {
  Column column;
  std::map<int, std::vector<double>> heights;  // by object, the highest first
  double from = kTop;
  for (int i = 0; i < 100; ++i) {
    const simulate::Hit hit = world_->caster().Cast({x, y, from}, {0, 0, -1});
    if (!hit.hit()) break;
    const double z = from - hit.range;
    if (is_ground_[static_cast<std::size_t>(hit.object)]) {
      column.ground = std::max(column.ground.value_or(z), z);
    } else {
      heights[hit.object].push_back(z);
    }
    from = z - kSkin;
  }
  for (const auto& [object, z] : heights) {
    for (std::size_t i = 0; i < z.size(); i += 2) {
      column.solids.push_back({i + 1 < z.size() ? z[i + 1] : z[i], z[i]});
    }
  }
  return column;
}

// Whether anything but ground stands upright in the square: sheets that vertical rays miss.
bool TerrainWorld::Crosses(const Vector2d& middle, double edge_m, double low_m,
                           double high_m) const {
  const auto meets = [&](const Vector3d& from, const Vector3d& along) {
    const simulate::Hit hit = world_->caster().Cast(from, along);
    return hit.hit() && hit.range < edge_m && !is_ground_[static_cast<std::size_t>(hit.object)];
  };
  for (int i = 0; i < kRays; ++i) {
    const double aside = ((i + 0.5) / kRays - 0.5) * edge_m;
    for (int level = 0; level <= kRays; ++level) {
      const double z = low_m + (high_m - low_m) * level / kRays;
      if (meets({middle.x() - edge_m / 2, middle.y() + aside, z}, {1, 0, 0}) ||
          meets({middle.x() + aside, middle.y() - edge_m / 2, z}, {0, 1, 0})) {
        return true;
      }
    }
  }
  return false;
}

TerrainWorld::Truth TerrainWorld::At(const Vector2d& place, double edge_m, double top_m,
                                     const TerrainOptions& options) const {
  const Vector2d middle = place - shift_;
  double heights[kRays + 1][kRays + 1];
  double lowest = kTop, highest = -kTop;
  for (int i = 0; i <= kRays; ++i) {
    for (int j = 0; j <= kRays; ++j) {
      const double x = middle.x() + (static_cast<double>(i) / kRays - 0.5) * edge_m * 0.999;
      const double y = middle.y() + (static_cast<double>(j) / kRays - 0.5) * edge_m * 0.999;
      const Column column = Look(x, y);
      if (!column.ground) return Truth::kNoGround;
      heights[i][j] = *column.ground;
      lowest = std::min(lowest, *column.ground);
      highest = std::max(highest, *column.ground);
      for (const Column::Solid& solid : column.solids) {
        if (solid.high > *column.ground + options.max_step_m &&
            solid.low < *column.ground + top_m) {
          return Truth::kObstacle;
        }
      }
    }
  }
  const double apart = edge_m / kRays;
  const double most = apart * std::tan(options.max_slope_rad);
  for (int i = 0; i < kRays; ++i) {
    for (int j = 0; j < kRays; ++j) {
      const double rise =
          std::hypot(heights[i + 1][j] - heights[i][j], heights[i][j + 1] - heights[i][j]);
      // A step: too much at once. A slope: too much, again and again.
      if (rise > options.max_step_m) return Truth::kObstacle;
    }
  }
  if (highest - lowest > kRays * 1.4143 * most) return Truth::kObstacle;
  return Crosses(middle, edge_m, highest + options.max_step_m + 0.001, lowest + top_m)
             ? Truth::kObstacle
             : Truth::kClear;
}

void TerrainScore::operator+=(const TerrainScore& other) {
  known += other.known;
  right += other.right;
  missed += other.missed;
  invented += other.invented;
  seen += other.seen;
  seen_known += other.seen_known;
  sites += other.sites;
  sites_on_obstacle += other.sites_on_obstacle;
}

namespace {

constexpr int kWellSeen = 10;  // points

bool OnObstacle(const TerrainWorld& world, const LandingSite& site, const TerrainOptions& options) {
  constexpr double kEdge = 0.05;
  for (double x = -site.radius_m; x <= site.radius_m; x += kEdge) {
    for (double y = -site.radius_m; y <= site.radius_m; y += kEdge) {
      if (std::hypot(x, y) > site.radius_m) continue;
      const auto truth = world.At(site.centre.head<2>() + Vector2d(x, y), kEdge,
                                  options.vehicle_height_m, options);
      if (truth != TerrainWorld::Truth::kClear) return true;
    }
  }
  return false;
}

}  // namespace

TerrainScore Score(const TerrainWorld& world, const Terrain& terrain,
                   const TerrainOptions& options) {
  TerrainScore score;
  const TerrainGrid& grid = terrain.grid;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const bool known = grid.state[cell] != CellState::kUnknown;
    const bool seen = grid.points[cell] >= kWellSeen;
    if (!known && !seen) continue;
    const auto truth = world.At(grid.Centre(cell), grid.cell_m, options.vehicle_height_m, options);
    if (truth == TerrainWorld::Truth::kNoGround) continue;
    score.seen += seen;
    score.seen_known += seen && known;
    if (!known) continue;
    const bool obstacle = truth == TerrainWorld::Truth::kObstacle;
    const bool said = grid.state[cell] == CellState::kObstacle;
    ++score.known;
    score.right += said == obstacle;
    score.missed += obstacle && !said;
    score.invented += said && !obstacle;
  }
  for (const LandingSite& site : terrain.sites) {
    ++score.sites;
    score.sites_on_obstacle += OnObstacle(world, site, options);
  }
  return score;
}

}  // namespace rgbdt::study
