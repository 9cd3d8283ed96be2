#include "calib/simulate/options.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "calib/model/errors.h"

namespace rgbdt::simulate {
namespace {

TEST(Options, DefaultsAreGood) { EXPECT_NO_THROW(Options().Check()); }

TEST(Options, BadOnesAreNamed) {
  const std::vector<std::pair<std::string, std::function<void(Options*)>>> cases{
      {"scanner.beams", [](Options* o) { o->scanner.beams = 0; }},
      {"scanner.beam_period_s", [](Options* o) { o->scanner.beam_period_s = -1; }},
      {"beam_period_s", [](Options* o) { o->scanner.beam_period_s = 1.234567e-4; }},
      {"scanner.range_sigma_m",
       [](Options* o) { o->scanner.range_sigma_m = std::numeric_limits<double>::quiet_NaN(); }},
      {"scanner.divergence_rings", [](Options* o) { o->scanner.divergence_rings = 1; }},
      {"scanner.sweep_rad", [](Options* o) { o->scanner.sweep_rad = 0; }},
      {"scanner's angle of a line", [](Options* o) { o->scanner.angle_step_rad = 0.1; }},
      {"scanner.guess_lever_m", [](Options* o) { o->scanner.guess_lever_m.z() = 5; }},
      {"scanner.guess_tilt_rad", [](Options* o) { o->scanner.guess_tilt_rad.x() = 5; }},
      {"cameras", [](Options* o) { o->cameras.clear(); }},
      {"width", [](Options* o) { o->cameras[0].width = 1935; }},
      {"thermal", [](Options* o) { o->cameras[1].netd_k = -0.05; }},
      {"two cameras", [](Options* o) { o->cameras[1].name = "rgb"; }},
      {"folds back", [](Options* o) { o->cameras[1].lens.distortion[0] = -0.9; }},
      {"board.width_m", [](Options* o) { o->board.width_m = 1; }},
      {"board.white_reflectivity", [](Options* o) { o->board.white_reflectivity = 1.5; }},
      {"board.border_k", [](Options* o) { o->board.border_k = 20; }},
      {"board.border_to_white", [](Options* o) { o->board.border_to_white = -0.1; }},
      {"dead_pixels", [](Options* o) { o->cameras[1].dead_pixels = -1; }},
      {"pose.outside_image", [](Options* o) { o->pose.outside_image = 1; }},
      {"holder.hands", [](Options* o) { o->holder.hands = 5; }},
      {"holder.hand_reach_m", [](Options* o) { o->holder.hand_reach_m = 1; }},
      {"holder.hand_k", [](Options* o) { o->holder.hand_k = 34; }},
      {"holder.person_aside_m", [](Options* o) { o->holder.person_aside_m = 5; }},
      {"pose.max_range_m", [](Options* o) { o->pose.max_range_m = 1; }},
      {"pose.max_tilt_rad", [](Options* o) { o->pose.max_tilt_rad = 40; }},
      {"world.ground_z_m", [](Options* o) { o->world.ground_z_m = 1; }},
      {"guess_rotation_rad", [](Options* o) { o->guess_rotation_rad = 2; }},
      {"pose.min_tilt", [](Options* o) { o->pose.min_tilt = 1; }},
      {"pose.near_preference", [](Options* o) { o->pose.near_preference = 0; }},
      {"pose.max_elevation_rad", [](Options* o) { o->pose.max_elevation_rad = -1; }},
      {"clutter.panel_m", [](Options* o) { o->clutter.panel_m.y() = 9; }},
      {"clutter.far_m", [](Options* o) { o->clutter.far_m = 2; }},
      {"clutter.door_ajar_rad", [](Options* o) { o->clutter.door_ajar_rad = -0.1; }},
      {"natural.step_m", [](Options* o) { o->natural.step_m = -0.5; }},
      {"natural.turn_rad", [](Options* o) { o->natural.turn_rad = 5; }},
      {"natural.people", [](Options* o) { o->natural.people = -1; }},
      {"natural.leaves", [](Options* o) { o->natural.leaves = -1; }},
      {"natural.on",
       [](Options* o) {
         o->natural.on = true;
         o->scene = Scene::kNight;
       }},
      {"natural.on", [](Options* o) { o->natural.on = o->clutter.door = true; }},
      {"spinning.range_sigma_m",
       [](Options* o) {
         UseLidar(16, o);
         o->spinning->range_sigma_m = 0;
       }},
      {"spinning.elevations_rad",
       [](Options* o) {
         UseLidar(16, o);
         std::swap(o->spinning->elevations_rad[3], o->spinning->elevations_rad[4]);
       }},
      {"number of spinning.elevations_rad", [](Options* o) { o->spinning = SpinningOptions(); }},
      {"spinning.azimuth_step_rad",
       [](Options* o) {
         UseLidar(16, o);
         o->spinning->azimuth_step_rad = 0;
       }},
      {"spinning.firing_share",
       [](Options* o) {
         UseLidar(32, o);
         o->spinning->firing_share = 1.5;
       }},
      {"spinning.beams_meet_m",
       [](Options* o) {
         UseLidar(16, o);
         o->spinning->beams_meet_m = -0.04;
       }},
      {"scanner.range_offset_m", [](Options* o) { o->scanner.range_offset_m = 2; }},
      {"scanner.dark_range_m", [](Options* o) { o->scanner.dark_range_m = -2; }},
      {"scanner.dark_noise", [](Options* o) { o->scanner.dark_noise = 0; }},
      {"lens_error", [](Options* o) { o->cameras[0].lens_error[2] = std::nan(""); }},
      {"lens_sigma", [](Options* o) { o->cameras[0].lens_sigma[2] = -1; }},
      {"lens + lens_error", [](Options* o) { o->cameras[1].lens_error[4] = -0.7; }},
      {"board.print_scale", [](Options* o) { o->board.print_scale.x() = 0; }},
      {"board.print_sigma", [](Options* o) { o->board.print_sigma = -0.003; }},
      {"supersampling", [](Options* o) { o->supersampling = 0; }},
  };
  for (const auto& [field, spoil] : cases) {
    Options options;
    spoil(&options);
    try {
      options.Check();
      ADD_FAILURE() << field << " was not refused";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace rgbdt::simulate
