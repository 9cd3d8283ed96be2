// What the fused cloud is for: temperatures of things, in the dark, too.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/fuse/fuse.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/simulator.h"
#include "services/simulator/simulated_sweep.h"

namespace rgbdt {
namespace {

using simulate::CloudWorld;
using simulate::Hit;

// The scene without a board, fused with the true calibration, and what each point is of.
struct FusedScene {
  simulate::Options options;
  RgbdtCloud fused;
  std::vector<Hit> hits;
  std::vector<Eigen::Vector3d> places;
  std::optional<CloudWorld> world;
  Eigen::Vector3d thermal_centre;

  explicit FusedScene(simulate::Scene scene) {
    options.seed = 41;
    options.scene = scene;
    const simulate::Simulator simulator(options);
    world.emplace(options, std::nullopt);
    thermal_centre = simulator.truth().camera_from_lidar.at("thermal").Inverse().translation;
    const Cloud cloud = TakeSweep(simulator, 1'000'000'000);
    std::vector<FusionCamera> cameras;
    for (const CameraSpec& spec : simulator.rig().cameras) {
      FusionCamera camera(spec);
      camera.calibrated = true;
      camera.camera_from_lidar = simulator.truth().camera_from_lidar.at(spec.name);
      camera.ServeAllTimes();
      camera.AddImage(Prepare(spec, simulator.TakeImage(spec.name, 1'000'000'000)));
      cameras.push_back(std::move(camera));
    }
    fused = Fuse(cloud, cameras, simulator.rig().lidar.range_sigma_m);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const Eigen::Vector3d origin =
          cloud.origins[i / static_cast<std::size_t>(cloud.beams)].cast<double>();
      const Eigen::Vector3d ray = (cloud.points[i].cast<double>() - origin).normalized();
      hits.push_back(world->world().caster().Cast(origin, ray));
      places.emplace_back(origin + hits.back().range * ray);
    }
  }

  const std::string& NameOf(std::size_t i) const { return world->world().Object(hits[i]).name; }
  // Whether the thermal camera sees the same thing all round: edges are blurred.
  bool IsInside(std::size_t i) const {
    constexpr double kRound = 0.012;  // 6 px
    const Eigen::Vector3d ray = (places[i] - thermal_centre).normalized();
    const Eigen::Vector3d a = ray.unitOrthogonal();
    const Eigen::Vector3d b = ray.cross(a);
    for (int k = 0; k < 12; ++k) {
      const Eigen::Vector3d beside =
          ray + kRound * (std::cos(k * M_PI / 6) * a + std::sin(k * M_PI / 6) * b);
      const Hit hit = world->world().caster().Cast(thermal_centre, beside.normalized());
      if (!hit.hit() || hit.object != hits[i].object) return false;
    }
    return true;
  }
};

constexpr std::uint32_t kThermalBit = 2;

// Points on things whose emissivity the rig file states; their true temperatures by the scene.
TEST(FusedScene, TemperaturesOfFlatSurfacesAreTrueWithinTheirSigma) {
  for (const auto scene : {simulate::Scene::kOutdoor, simulate::Scene::kIndoor}) {
    const FusedScene s(scene);
    double squares = 0;
    int within = 0;
    int count = 0;
    for (std::size_t i = 0; i < s.hits.size(); ++i) {
      if (!s.hits[i].hit() || (s.fused.valid[i] & kThermalBit) == 0 || !s.IsInside(i)) continue;
      const auto& object = s.world->world().Object(s.hits[i]);
      if (object.material.emissivity != 0.95 || object.material.texture.temperature_k != 0) {
        continue;
      }
      const double error = s.fused.temperature_k[i] - object.material.temperature_k;
      const double sigma = s.fused.temperature_sigma_k[i];
      squares += error * error / (sigma * sigma);
      within += std::abs(error) <= 2 * s.options.cameras[1].netd_k ? 1 : 0;
      ++count;
    }
    ASSERT_GT(count, 1000);
    EXPECT_GE(within, 0.95 * count);
    // A bilinear sample averages up to four pixels: never noisier than stated, hardly half of it.
    EXPECT_LT(std::sqrt(squares / count), 1.1);
    EXPECT_GT(std::sqrt(squares / count), 0.4);
  }
}

// The paper's Figure 1.
TEST(FusedScene, AtNightThePersonIsDarkButWarm) {
  const FusedScene s(simulate::Scene::kNight);
  std::vector<float> person;
  std::vector<float> rest;
  double brightest = 0;
  for (std::size_t i = 0; i < s.hits.size(); ++i) {
    if (!s.hits[i].hit() || s.fused.valid[i] != 3 || !s.IsInside(i)) continue;
    const std::string& name = s.NameOf(i);
    const bool is_person = name == "torso" || name == "head" || name == "leg" || name == "arm";
    (is_person ? person : rest).push_back(s.fused.temperature_k[i]);
    if (is_person) brightest = std::max(brightest, double(s.fused.rgb[i][1]));
  }
  ASSERT_GT(person.size(), 50U);
  ASSERT_GT(rest.size(), 5000U);
  EXPECT_LT(brightest, 40) << "the colour image shows the person";
  // One temperature tells them apart.
  std::sort(person.begin(), person.end());
  std::sort(rest.begin(), rest.end());
  const float threshold = 0.5F * (person[person.size() / 2] + rest[rest.size() / 2]);
  const auto warm =
      std::count_if(person.begin(), person.end(), [&](float t) { return t > threshold; });
  const auto cold = std::count_if(rest.begin(), rest.end(), [&](float t) { return t < threshold; });
  EXPECT_GE(warm, 0.98 * static_cast<double>(person.size()));
  EXPECT_GE(cold, 0.99 * static_cast<double>(rest.size()));
}

}  // namespace
}  // namespace rgbdt
