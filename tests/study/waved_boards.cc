#include "tests/study/waved_boards.h"

#include <cmath>

#include "calib/simulate/internal/dice.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using simulate::Noise;

WavedCamera SampleCamera(const simulate::Waving& waving, const WavedScene& scene,
                         std::size_t index) {
  const CameraSpec& spec = waving.rig().cameras[index];
  WavedCamera camera;
  camera.spec = spec;
  simulate::Dice draw(scene.options.seed, static_cast<std::int64_t>(index), "free-running");
  const double period = 1 / scene.rates_hz[index];
  const double phase = draw.Between(0, period);
  const double sigma_px = CornerSigma(spec.kind);
  for (int k = 0; phase + k * period < scene.seconds; ++k) {
    const Utime utime = scene.wave.start + FromSeconds(phase + k * period);
    const auto corners = waving.Corners(spec.name, utime);
    if (corners.empty()) continue;
    const Noise noise(scene.options.seed, utime, spec.name + " corners");
    WavedImage image;
    image.utime = waving.CameraUtime(spec.name, utime) +
                  FromSeconds(scene.jitter_s * noise.Normal(1'000'000));
    image.corners = SampledCorners(corners, sigma_px, noise);
    camera.images.push_back(std::move(image));
  }
  return camera;
}

}  // namespace

WavedScene ColorCamera(std::uint64_t seed, int rings) {
  WavedScene scene;
  scene.options.seed = seed;
  simulate::UseLidar(rings, &scene.options);
  scene.options.cameras = {simulate::DefaultColorCamera()};
  scene.clocks.resize(1);
  scene.rates_hz = {20};
  return scene;
}

WavedScene TwoCameras(std::uint64_t seed, int rings) {
  WavedScene scene = ColorCamera(seed, rings);
  scene.options.cameras.push_back(simulate::DefaultThermalCamera());
  scene.clocks.resize(2);
  scene.rates_hz.push_back(9);
  return scene;
}

WavedBoard SampleWavedBoard(const WavedScene& scene, Truth* truth) {
  const simulate::Waving waving(scene.options, scene.wave, scene.clocks);
  WavedBoard board;
  board.target = waving.rig().target;
  board.range_sigma_m = waving.rig().lidar.range_sigma_m;
  board.range_offset_sigma_m = waving.rig().lidar.range_offset_sigma_m;
  const double step = scene.sweep_s > 0 ? scene.sweep_s : scene.options.spinning->revolution_s;
  for (double t = 0; t < scene.seconds; t += step) {
    board.sweeps.push_back(TakeWavedSweep(waving.Sweep(scene.wave.start + FromSeconds(t)), 8));
  }
  for (std::size_t i = 0; i < scene.rates_hz.size(); ++i) {
    board.cameras.push_back(SampleCamera(waving, scene, i));
  }
  if (truth != nullptr) *truth = waving.truth();
  return board;
}

void BeginNearTruth(const Truth& truth, double turn_rad, double shift_m, WavedBoard* board) {
  for (WavedCamera& camera : board->cameras) {
    Vector6d off;
    off << turn_rad, -turn_rad, turn_rad, shift_m, shift_m, -shift_m;
    camera.camera_from_lidar =
        Exp(off / std::sqrt(3)) * truth.camera_from_lidar.at(camera.spec.name);
  }
}

void AddSweepBoards(const WavedScene& scene, WavedBoard* board) {
  const simulate::Waving waving(scene.options, scene.wave, scene.clocks);
  for (WavedSweep& sweep : board->sweeps) {
    const Utime middle = sweep.utime[sweep.utime.size() / 2];
    const Noise noise(scene.options.seed, middle, "sweep board");
    Vector6d off;
    for (int i = 0; i < 6; ++i) {
      off[i] = (i < 3 ? 0.009 : 0.01) * noise.Normal(static_cast<std::uint64_t>(i));
    }
    Rigid3 pose = waving.LidarFromTarget(middle) * Exp(off);
    if (noise.Uniform(10) < 0.5) pose = pose * RotationAbout(Eigen::Vector3d::UnitZ(), M_PI);
    sweep.boards = {{middle, pose}};
  }
}

}  // namespace rgbdt::study
