#include "calib/simulate/options.h"

#include <cmath>
#include <set>

#include "calib/model/errors.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/lens_table.h"
#include "calib/simulate/internal/option_checks.h"

namespace rgbdt::simulate {
namespace {

void Check(const ScannerOptions& o) {
  kCheck.Between(o.beams, 2, 10000, "scanner.beams");
  kCheck.Between(o.first_angle_rad, -180 * kDegree, 90 * kDegree, "scanner.first_angle_rad");
  kCheck.Positive(o.angle_step_rad, "scanner.angle_step_rad");
  kCheck.Between(o.angle_step_rad * (o.beams - 1), 0, 360 * kDegree,
                 "scanner's angle of a line [rad]");
  kCheck.Positive(o.beam_period_s, "scanner.beam_period_s");
  const double line_us = o.beams * o.beam_period_s * 1e6;
  kCheck.Require(std::abs(line_us - std::round(line_us)) < 1e-6,
                 "scanner.beams * beam_period_s [us]", line_us, "whole microseconds");
  kCheck.Positive(o.motor_speed_rad_s, "scanner.motor_speed_rad_s");
  kCheck.Between(o.sweep_start_rad, -360 * kDegree, 360 * kDegree, "scanner.sweep_start_rad");
  kCheck.Between(o.sweep_rad, 1e-3, 360 * kDegree, "scanner.sweep_rad");
  kCheck.Require(std::isfinite(o.ticks_per_rad) && o.ticks_per_rad != 0, "scanner.ticks_per_rad",
                 o.ticks_per_rad, "a number other than zero");
  kCheck.Require(std::isfinite(o.zero_ticks), "scanner.zero_ticks", o.zero_ticks,
                 "a finite number");
  kCheck.Between(o.encoder_delay_s, -1, 1, "scanner.encoder_delay_s");
  kCheck.Require(o.lever_arm_m.norm() < 1, "length of scanner.lever_arm_m", o.lever_arm_m.norm(),
                 "less than 1");
  kCheck.Require(o.tilt_rad.norm() < 0.5, "length of scanner.tilt_rad", o.tilt_rad.norm(),
                 "less than 0.5");
  kCheck.Require(o.guess_lever_m.norm() < 0.1, "length of scanner.guess_lever_m",
                 o.guess_lever_m.norm(), "less than 0.1");
  kCheck.Require(o.guess_tilt_rad.norm() < 0.2, "length of scanner.guess_tilt_rad",
                 o.guess_tilt_rad.norm(), "less than 0.2");
  o.BeamOptions::Check("scanner.");
}

void Check(const CameraOptions& o, const std::string& field) {
  kCheck.Between(o.width, 8, 20000, field + "width");
  kCheck.Between(o.height, 8, 20000, field + "height");
  kCheck.Require(o.width % 2 == 0 && o.height % 2 == 0, field + "width * height",
                 double(o.width) * o.height, "an even width and an even height (mosaic)");
  kCheck.Positive(o.lens.fx, field + "lens.fx");
  kCheck.Positive(o.lens.fy, field + "lens.fy");
  kCheck.Require(o.position_m.norm() < 5, "length of " + field + "position_m", o.position_m.norm(),
                 "less than 5");
  kCheck.NotNegative(o.position_spread_m, field + "position_spread_m");
  kCheck.Between(o.tilt_rad, 0, 30 * kDegree, field + "tilt_rad");
  kCheck.Between(o.blur_px, 0, 20, field + "blur_px");
  kCheck.NotNegative(o.noise_dn, field + "noise_dn");
  kCheck.Between(o.white_dn, 1, 255, field + "white_dn");
  kCheck.NotNegative(o.netd_k, field + "netd_k");
  kCheck.Positive(o.gain_k, field + "gain_k");
  kCheck.NotNegative(o.offset_k, field + "offset_k");
  kCheck.Between(o.bits, 8, 16, field + "bits");
  kCheck.Positive(o.exposure_s, field + "exposure_s");
  kCheck.NotNegative(o.readout_s, field + "readout_s");
  kCheck.Between(o.dead_pixels, 0, 10000, field + "dead_pixels");
  CheckLens(o.lens, o.width, o.height, field + "lens");
  kCheck.Require(o.lens_error.allFinite(), field + "lens_error", o.lens_error.sum(),
                 "finite numbers");
  kCheck.NotNegative(o.lens_sigma.minCoeff(), "least of " + field + "lens_sigma");
  CheckLens(RigLens(o), o.width, o.height, field + "lens + lens_error");
}

void Check(const BoardOptions& o) {
  kCheck.Between(o.squares_x, 3, 100, "board.squares_x");
  kCheck.Between(o.squares_y, 3, 100, "board.squares_y");
  kCheck.Positive(o.square_m, "board.square_m");
  kCheck.Between(o.print_scale.minCoeff(), 0.9, 1.1, "least of board.print_scale");
  kCheck.Between(o.print_scale.maxCoeff(), 0.9, 1.1, "most of board.print_scale");
  kCheck.Between(o.print_sigma, 0, 0.1, "board.print_sigma");
  if (o.markers) {
    const MarkerFamily* family = FindMarkerFamily(o.markers->family);
    kCheck.Require(family != nullptr, "board.markers.family", 0, "one of " + MarkerFamilyNames());
    kCheck.Positive(o.markers->side_m, "board.markers.side_m");
    kCheck.Between(o.markers->border_bits, 1, 4, "board.markers.border_bits");
    kCheck.NotNegative(o.markers->gap_m, "board.markers.gap_m");
  }
  const Eigen::Vector2d pattern = MakeTarget(o).PatternSize().cwiseProduct(o.print_scale);
  kCheck.Require(o.width_m >= pattern.x(), "board.width_m", o.width_m,
                 "at least the pattern's width");
  kCheck.Require(o.height_m >= pattern.y(), "board.height_m", o.height_m,
                 "at least the pattern's height");
  kCheck.Positive(o.thickness_m, "board.thickness_m");
  kCheck.Between(o.black_reflectivity, 0, 1, "board.black_reflectivity");
  kCheck.Between(o.white_reflectivity, 1e-3, 1, "board.white_reflectivity");
  kCheck.Between(o.emissivity, 0.05, 1, "board.emissivity");
  if (o.temperature_k) kCheck.Between(*o.temperature_k, 150, 600, "board.temperature_k");
  if (o.black_minus_white_k)
    kCheck.Between(*o.black_minus_white_k, -100, 100, "board.black_minus_white_k");
  if (o.gradient_k) kCheck.Between(*o.gradient_k, -100, 100, "board.gradient_k");
  if (o.glow_k) kCheck.Between(*o.glow_k, -100, 100, "board.glow_k");
  kCheck.Positive(o.glow_radius_m, "board.glow_radius_m");
  kCheck.NotNegative(o.hidden_outline_m, "board.hidden_outline_m");
  kCheck.Positive(o.hidden_depth_m, "board.hidden_depth_m");
  if (o.border_k) kCheck.Between(*o.border_k, 150, 600, "board.border_k");
  kCheck.Between(o.border_to_white, 0, 1, "board.border_to_white");
  kCheck.Positive(o.stand_m, "board.stand_m");
  kCheck.Between(o.stand_reflectivity, 0, 1, "board.stand_reflectivity");
}

void Check(const PoseOptions& o) {
  kCheck.Positive(o.min_range_m, "pose.min_range_m");
  kCheck.Require(o.max_range_m >= o.min_range_m, "pose.max_range_m", o.max_range_m,
                 "at least pose.min_range_m");
  kCheck.Between(o.max_tilt_rad, 0, 80 * kDegree, "pose.max_tilt_rad");
  kCheck.Between(o.max_roll_rad, 0, 180 * kDegree, "pose.max_roll_rad");
  kCheck.Between(o.image_margin, 0, 0.4, "pose.image_margin");
  kCheck.Between(o.sweep_margin_rad, 0, 1, "pose.sweep_margin_rad");
  kCheck.NotNegative(o.clearance_m, "pose.clearance_m");
  kCheck.Between(o.near_preference, 0.1, 10, "pose.near_preference");
  kCheck.Between(o.min_tilt, 0, 0.98, "pose.min_tilt");
  kCheck.Between(o.max_azimuth_rad, 0, 180 * kDegree, "pose.max_azimuth_rad");
  kCheck.Between(o.min_elevation_rad, -80 * kDegree, 80 * kDegree, "pose.min_elevation_rad");
  kCheck.Between(o.max_elevation_rad, o.min_elevation_rad, 80 * kDegree, "pose.max_elevation_rad");
  kCheck.Between(o.outside_image, 0, 0.9, "pose.outside_image");
}

void Check(const HolderOptions& o) {
  kCheck.Between(o.hands, 0, 4, "holder.hands");
  kCheck.Between(o.hand_reach_m, 0, 0.3, "holder.hand_reach_m");
  kCheck.Between(o.hand_k, 250, 350, "holder.hand_k");
  kCheck.Between(o.person_aside_m, -2, 2, "holder.person_aside_m");
}

void Check(const FurtherLidarOptions& o) {
  const std::string field = "LIDAR \"" + o.name + "\" ";
  o.spinning.Check();
  kCheck.Require(o.position_m.norm() < 5, "length of " + field + "position_m", o.position_m.norm(),
                 "less than 5");
  kCheck.Between(o.position_spread_m, 0, 1, field + "position_spread_m");
  kCheck.Between(o.tilt_rad, 0, 30 * kDegree, field + "tilt_rad");
  kCheck.Between(o.turn_rad, 0, 180 * kDegree, field + "turn_rad");
}

}  // namespace

ScannerOptions FullTurnScanner() {
  ScannerOptions o;
  o.beams = 540;
  o.first_angle_rad = -45 * kDegree;
  o.angle_step_rad = 0.5 * kDegree;
  o.motor_speed_rad_s = 12 * kDegree;
  o.sweep_start_rad = -180 * kDegree;
  o.sweep_rad = 360 * kDegree;
  return o;
}

Lens RigLens(const CameraOptions& camera) {
  return WithNumbers(camera.lens, NumbersOf(camera.lens) + camera.lens_error);
}

CameraOptions DefaultColorCamera() {
  CameraOptions o;
  o.name = "rgb";
  o.kind = CameraKind::kColor;
  o.width = 1936;
  o.height = 1456;
  o.lens.fx = o.lens.fy = 1100;
  o.lens.cx = 971.3;
  o.lens.cy = 722.6;
  o.lens.distortion = {-0.11, 0.07, 4e-4, -3e-4, -0.012, 0, 0, 0};
  o.position_m = {0.06, 0.11, 0.09};
  o.blur_px = 0.7;
  o.noise_dn = 2;
  return o;
}

CameraOptions DefaultThermalCamera() {
  CameraOptions o;
  o.name = "thermal";
  o.kind = CameraKind::kThermal;
  o.width = 640;
  o.height = 480;
  o.lens.fx = o.lens.fy = 530;
  o.lens.cx = 317.2;
  o.lens.cy = 243.1;
  o.lens.distortion = {-0.24, 0.11, -6e-4, 5e-4, -0.02, 0, 0, 0};
  o.position_m = {0.05, -0.13, 0.10};
  o.blur_px = 1;
  o.netd_k = 0.05;
  o.exposure_s = 0.01;
  return o;
}

const BeamOptions& Options::beam() const {
  if (livox) return *livox;
  return spinning ? static_cast<const BeamOptions&>(*spinning) : scanner;
}

void Options::Check() const {
  simulate::Check(scanner);
  if (spinning) spinning->Check();
  if (livox) livox->Check();
  kCheck.Require(!spinning || !livox, "livox", 1, "no spinning LIDAR besides");
  if (cameras.empty()) throw InputError("simulator: cameras is empty; expected at least one");
  std::set<std::string> names;
  for (const CameraOptions& camera : cameras) {
    simulate::Check(camera, "camera \"" + camera.name + "\" ");
    if (!names.insert(camera.name).second) {
      throw InputError("simulator: two cameras are named \"" + camera.name + "\"");
    }
  }
  simulate::Check(board);
  simulate::Check(pose);
  clutter.Check();
  natural.Check();
  kCheck.Require(!natural.on || scene != Scene::kNight, "natural.on", 1, "0 in the scene `night`");
  kCheck.Require(!natural.on || !clutter.any(), "natural.on", 1, "0 where there is clutter");
  simulate::Check(holder);
  kCheck.Between(world.ground_z_m, -5, -0.5, "world.ground_z_m");
  kCheck.Between(world.person_temperature_k, 250, 350, "world.person_temperature_k");
  kCheck.Require(world.reflected_temperature_k == 0 ||
                     (world.reflected_temperature_k > 100 && world.reflected_temperature_k < 500),
                 "world.reflected_temperature_k", world.reflected_temperature_k,
                 "0 (the scene's own) or 100 to 500");
  kCheck.Positive(world.lamp_range_m, "world.lamp_range_m");
  kCheck.Between(guess_rotation_rad, 0, 90 * kDegree, "guess_rotation_rad");
  kCheck.NotNegative(guess_translation_m, "guess_translation_m");
  kCheck.NotNegative(pick_sigma_px, "pick_sigma_px");
  kCheck.Between(supersampling, 1, 16, "supersampling");
  kCheck.Between(threads, 0, 256, "threads");
  for (const FurtherLidarOptions& lidar : further_lidars) simulate::Check(lidar);
}

void UseLidar(int rings, Options* options) {
  options->spinning.reset();
  options->livox.reset();
  if (rings == 0) return;
  if (rings == kMid360 || rings == kAvia) {
    options->livox = LivoxLidar(rings == kAvia ? LivoxModel::kAvia : LivoxModel::kMid360);
    return;
  }
  options->spinning = SpinningLidar(rings);
  if (rings == 64) options->world.ground_z_m = -2;
}

void AddLidar(int rings, Options* options) {
  constexpr double kAside = 0.5;
  const std::size_t before = options->further_lidars.size();
  FurtherLidarOptions& lidar = options->further_lidars.emplace_back();
  lidar.name = "lidar" + std::to_string(before + 2);
  lidar.spinning = SpinningLidar(rings);
  const double side = before % 2 == 0 ? 1 : -1;
  if (rings == 64) options->world.ground_z_m = -2;
  const std::size_t pair = 1 + before / 2;
  lidar.position_m = {-0.1, side * kAside * static_cast<double>(pair), 0.1};
}

}  // namespace rgbdt::simulate
