#include "tests/study/livox_scenes.h"

#include <array>
#include <cmath>

#include "calib/model/errors.h"
#include "calib/simulate/internal/cloud_world.h"

namespace rgbdt::study {
namespace {

constexpr Utime kUtime = 1'433'160'000'000'000;
constexpr int kViewsPerSeed = 10;  // then scenery, clutter and noise are drawn afresh

simulate::Options OptionsOf(simulate::LivoxModel model, int index, std::uint64_t seed) {
  static const std::array<const char*, 7> kThings = {"door",   "poster",       "table", "panel",
                                                     "person", "second_board", "easel"};
  simulate::Options options;
  simulate::UseLidar(model == simulate::LivoxModel::kAvia ? simulate::kAvia : simulate::kMid360,
                     &options);
  options.seed = 1000 * seed + static_cast<std::uint64_t>(index / kViewsPerSeed);
  options.scene = static_cast<simulate::Scene>(index % 3);
  options.threads = 1;  // the study runs one model on each core
  options.pose.min_range_m = 3;
  options.pose.max_range_m = 8;
  options.pose.near_preference = 1;
  options.pose.max_roll_rad = M_PI;
  const auto i = static_cast<std::size_t>(index);
  if (i % 2 == 1) AddClutter(kThings[i / 2 % kThings.size()], &options.clutter);
  return options;
}

}  // namespace

void RenderLivoxClouds(simulate::LivoxModel model, int count, std::uint64_t seed,
                       const std::function<void(int, const CloudScene&)>& take) {
  int made = 0;
  for (int index = 0; made < count; ++index) {
    if (index > 3 * count + 30) throw InputError("study: no room in the scenes");
    const simulate::Options options = OptionsOf(model, index, seed);
    CloudScene scene;
    try {
      const simulate::CloudWorld world(options, index);
      scene.cloud = world.Sweep(kUtime + 7'654'321 * static_cast<Utime>(index));
      scene.target = world.target();
      scene.lidar_from_target = world.lidar_from_target();
    } catch (const InputError&) {  // no room for the board, or for the clutter
      continue;
    }
    scene.range_sigma_m = options.livox->range_sigma_m;
    scene.form = index % 2 == 1 ? "cluttered" : "plain";
    for (const auto& [name, value] : simulate::kSceneNames) {
      if (value == options.scene) scene.scene = name;
    }
    take(index, scene);
    ++made;
  }
}

}  // namespace rgbdt::study
