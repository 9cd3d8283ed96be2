#include "tests/study/cloud_scenes.h"

#include <optional>

#include "calib/model/errors.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/spinning.h"
#include "tests/numbers.h"
#include "tests/simulated_variants.h"

namespace rgbdt::study {
namespace {

using simulate::CloudWorld;
using simulate::Options;

constexpr int kViewsPerSeed = 10;  // then scenery, clutter and noise are drawn afresh
constexpr double kPi = 3.14159265358979323846;
// A board 1.52 m across is not wholly within 30 degrees where it is nearer.
constexpr double kNearest16RingsM = 2.4;

Options OptionsOf(const CloudClass& cloud_class, int index, std::uint64_t seed) {
  Options options;
  options.seed = 1000 * seed + static_cast<std::uint64_t>(index / kViewsPerSeed);
  options.scene = static_cast<simulate::Scene>(index % 3);
  options.threads = 1;  // the study runs one class on each core
  if (cloud_class.rings > 0) simulate::UseLidar(cloud_class.rings, &options);
  options.pose.min_range_m = cloud_class.min_range_m;
  options.pose.max_range_m = cloud_class.max_range_m;
  options.pose.near_preference = 1;
  options.pose.max_roll_rad = kPi;
  if (!cloud_class.clutter.empty()) AddClutter(cloud_class.clutter, &options.clutter);
  return options;
}

// Nothing where the scene has no room for the board or the clutter.
std::optional<CloudWorld> TryWorld(const Options& options, int index) {
  try {
    return CloudWorld(options, index);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string NameOf(simulate::Scene scene) {
  for (const auto& [name, value] : simulate::kSceneNames) {
    if (value == scene) return name;
  }
  return "";
}

CloudScene Render(const CloudWorld& world, const Options& options, int index) {
  CloudScene made;
  made.cloud = world.Sweep(kJune2015 + index);
  made.form = "organised";
  if (index / 3 % 2 == 1) {  // independent of the scene, which changes with every index
    const bool ring = index / 6 % 2 == 1;
    made.form = ring ? "ring" : "bare";
    const bool shuffle = index / 12 % 2 == 1;
    made.cloud = simulate::Unorganised(
        made.cloud, ring, shuffle ? std::optional<std::uint64_t>(index) : std::nullopt);
  }
  made.target = world.target();
  made.lidar_from_target = world.lidar_from_target();
  made.range_sigma_m =
      options.spinning ? options.spinning->range_sigma_m : options.scanner.range_sigma_m;
  made.scene = NameOf(options.scene);
  return made;
}

}  // namespace

std::vector<CloudClass> CloudClasses() {
  std::vector<CloudClass> classes{{"dense", 0, 1.5, 10, "", 100},
                                  {"128", 128, 1.5, 10, "", 30},
                                  {"64", 64, 1.5, 10, "", 30},
                                  {"32", 32, 1.5, 10, "", 100},
                                  {"16_4m", 16, kNearest16RingsM, 4, "", 100},
                                  {"16_beyond_4m", 16, 4, 8, "", 30}};
  for (const int rings : {0, 32}) {
    for (const char* thing :
         {"door", "poster", "table", "panel", "second_board", "person", "easel"}) {
      const std::string lidar = rings == 0 ? "dense" : std::to_string(rings);
      classes.push_back({lidar + "_" + thing, rings, 2, 6, thing, 20});
    }
  }
  return classes;
}

void AddClutter(const std::string& name, simulate::ClutterOptions* clutter) {
  if (name == "door") {
    clutter->door = true;
  } else if (name == "poster") {
    clutter->poster = true;
  } else if (name == "table") {
    clutter->table = true;
  } else if (name == "panel") {
    clutter->panel = true;
  } else if (name == "second_board") {
    clutter->second_board = true;
  } else if (name == "person") {
    clutter->holder = simulate::Holder::kPerson;
  } else if (name == "easel") {
    clutter->holder = simulate::Holder::kEasel;
  } else {
    throw InputError("study: no clutter '" + name + "'");
  }
}

void RenderClouds(const CloudClass& cloud_class, int count, std::uint64_t seed,
                  const std::function<void(int, const CloudScene&)>& take) {
  // Scenes without room for the board are passed over; there are few.
  int made = 0;
  for (int index = 0; made < count; ++index) {
    if (index > 3 * count + 30) throw InputError("study: no room in the scenes");
    const Options options = OptionsOf(cloud_class, index, seed);
    const std::optional<CloudWorld> world = TryWorld(options, index);
    if (!world) continue;
    take(index, Render(*world, options, index));
    ++made;
  }
}

PoseError ErrorOf(const TargetPose& pose, const Rigid3& sensor_from_target) {
  const Rigid3& found = pose.sensor_from_target;
  Rigid3 truth = sensor_from_target;
  const Rigid3 turned = truth * RotationAbout({0, 0, 1}, kPi);
  if (RotationDistance(found, turned) < RotationDistance(found, truth)) truth = turned;
  const Vector6d delta = Log(truth * found.Inverse());
  PoseError error;
  error.rotation_deg = RotationDistance(found, truth) / simulate::kDegree;
  error.centre_mm = 1e3 * (found.translation - truth.translation).norm();
  error.chi2 = delta.dot(pose.covariance.ldlt().solve(delta));
  return error;
}

int FindAmong(const std::vector<CloudEdges>& candidates, const Rigid3& lidar_from_target) {
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (ErrorOf(*candidates[k].pose, lidar_from_target).IsBoard()) return static_cast<int>(k);
  }
  return -1;
}

}  // namespace rgbdt::study
