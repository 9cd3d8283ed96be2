#include "calib/simulate/internal/rig_defaults.h"

#include <cmath>

#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {

Eigen::Vector3d DrawDirection(const Noise& noise, std::uint64_t index) {
  const double z = noise.Uniform(index, -1, 1);
  const double angle = noise.Uniform(index + 1, 0, 360 * kDegree);
  const double flat = std::sqrt(1 - z * z);
  return {flat * std::cos(angle), flat * std::sin(angle), z};
}

Rigid3 DrawCameraFromLidar(const CameraOptions& camera, std::uint64_t seed) {
  const Noise noise(seed, 0, camera.name + " mount");
  Eigen::Matrix3d axes;  // rows: camera's x, y, z in the LIDAR frame
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Eigen::Vector3d centre = camera.position_m;
  for (int k = 0; k < 3; ++k) {
    centre[k] += camera.position_spread_m * noise.Uniform(static_cast<std::uint64_t>(k), -1, 1);
  }
  const double angle = camera.tilt_rad * noise.Uniform(3, 0.3, 1);
  Rigid3 camera_from_lidar;
  camera_from_lidar.rotation =
      (RotationAbout(DrawDirection(noise, 4), angle).rotation * Eigen::Quaterniond(axes))
          .normalized();
  camera_from_lidar.translation = -(camera_from_lidar.rotation * centre);
  return camera_from_lidar;
}

Rigid3 DrawReferenceFromLidar(const FurtherLidarOptions& lidar, std::uint64_t seed) {
  const Noise noise(seed, 0, lidar.name + " mount");
  const double heading = noise.Uniform(0, 0, 2 * M_PI);  // of the axis that it is tilted about
  const Eigen::Vector3d axis(std::cos(heading), std::sin(heading), 0);
  Rigid3 reference_from_lidar =
      RotationAbout(axis, lidar.tilt_rad * noise.Uniform(1, 0.3, 1)) *
      RotationAbout(Eigen::Vector3d::UnitZ(), lidar.turn_rad * noise.Uniform(2, -1, 1));
  reference_from_lidar.rotation.normalize();
  for (int k = 0; k < 3; ++k) {
    reference_from_lidar.translation[k] =
        lidar.position_m[k] +
        lidar.position_spread_m * noise.Uniform(3 + static_cast<std::uint64_t>(k), -1, 1);
  }
  return reference_from_lidar;
}

std::uint64_t SeedOfLidar(std::uint64_t seed, std::size_t index) {
  return seed + (index + 1) * 0x9e3779b97f4a7c15U;
}

Rigid3 DrawGuess(const Options& options, const std::string& camera,
                 const Rigid3& camera_from_lidar) {
  const Noise noise(options.seed, 0, camera + " guess");
  const double angle = options.guess_rotation_rad * noise.Uniform(0, 0.4, 1);
  const double shift = options.guess_translation_m * noise.Uniform(1, 0.4, 1);
  const Eigen::Vector3d centre =
      camera_from_lidar.Inverse().translation + shift * DrawDirection(noise, 2);
  Rigid3 guess;
  guess.rotation =
      (RotationAbout(DrawDirection(noise, 4), angle).rotation * camera_from_lidar.rotation)
          .normalized();
  guess.translation = -(guess.rotation * centre);
  return guess;
}

namespace {

// What the rig file says of the scanner.
TurnedScanner GuessOf(const ScannerOptions& options, TurnedScanner truth) {
  Rigid3& guess = truth.motor_from_scanner;
  const double angle = options.guess_tilt_rad.norm();
  if (angle > 0) {
    guess.rotation =
        (RotationAbout(options.guess_tilt_rad / angle, angle).rotation * guess.rotation)
            .normalized();
  }
  guess.translation += options.guess_lever_m;
  return truth;
}

}  // namespace

Rig MakeRig(const Options& options, const Scanner& scanner, const SceneModel& scene,
            const std::vector<Rigid3>& camera_from_lidar) {
  Rig rig;
  rig.name = "simulated";
  rig.lidar.name = "lidar";
  if (options.turned()) {
    rig.lidar.turned_scanner = GuessOf(options.scanner, scanner.geometry());
  }
  rig.lidar.range_sigma_m = options.beam().range_sigma_m;
  for (const FurtherLidarOptions& further : options.further_lidars) {
    LidarSpec& lidar = rig.further_lidars.emplace_back();
    lidar.name = further.name;
    lidar.range_sigma_m = further.spinning.range_sigma_m;
  }
  for (std::size_t i = 0; i < options.cameras.size(); ++i) {
    const CameraOptions& from = options.cameras[i];
    CameraSpec camera;
    camera.name = from.name;
    camera.kind = from.kind;
    camera.width = from.width;
    camera.height = from.height;
    camera.lens = RigLens(from);
    camera.lens_uncertainty = LensUncertainty{};
    camera.lens_uncertainty->covariance.diagonal() = from.lens_sigma.cwiseAbs2();
    camera.readout_s = from.readout_s;
    camera.format = PixelFormat::kBayerRg8;
    if (from.kind == CameraKind::kThermal) {
      camera.format = PixelFormat::kMono16;
      camera.netd_k = from.netd_k;
      camera.radiometry.kind = Radiometry::Kind::kLinear;
      camera.radiometry.gain = from.gain_k;
      camera.radiometry.offset = from.offset_k;
      camera.radiometry.emissivity = options.board.emissivity;
      camera.radiometry.reflected_temperature_k = scene.reflected_temperature_k;
    }
    camera.camera_from_lidar_guess = DrawGuess(options, from.name, camera_from_lidar[i]);
    rig.cameras.push_back(camera);
  }
  rig.target = MakeTarget(options.board);
  rig.Check();
  return rig;
}

}  // namespace rgbdt::simulate
