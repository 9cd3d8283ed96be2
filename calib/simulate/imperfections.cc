#include "calib/simulate/imperfections.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/model/beam_priors.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/spinning.h"

namespace rgbdt::simulate {
namespace {

constexpr double kMostSigmas = 2.5;  // no rig is off by more: lenses must not fold back

double Normal(const Noise& noise, std::uint64_t index) {
  return std::clamp(noise.Normal(index), -kMostSigmas, kMostSigmas);
}

void DrawLens(std::uint64_t seed, CameraOptions* camera) {
  const Noise noise(seed, 0, "imperfect lens of " + camera->name);
  const double centre_px = 0.006 * camera->width;
  camera->lens_sigma << 0.005 * camera->lens.fx, 0.005 * camera->lens.fy, centre_px, centre_px,
      0.02, 0, 0, 0, 0;
  for (Eigen::Index i = 0; i < camera->lens_error.size(); ++i) {
    camera->lens_error[i] = camera->lens_sigma[i] * Normal(noise, static_cast<std::uint64_t>(i));
  }
}

void DrawPrint(std::uint64_t seed, BoardOptions* board) {
  const Noise noise(seed, 0, "imperfect print");
  board->print_sigma = kUsualPrintSigma;
  board->print_scale = {1 + board->print_sigma * Normal(noise, 0),
                        1 + board->print_sigma * Normal(noise, 1)};
}

void DrawBeam(std::uint64_t seed, BeamOptions* beam) {
  const Noise noise(seed, 0, "imperfect beam");
  beam->range_offset_m = kUsualRangeOffsetSigmaM * Normal(noise, 0);
  beam->dark_range_m = noise.Uniform(1, 0, 0.02);
  beam->divergence_rad = noise.Uniform(2, 1.5e-3, 4e-3);
  beam->min_return = std::exp(noise.Uniform(3, std::log(0.005), std::log(0.03)));
  beam->merge_m = noise.Uniform(4, 0.3, 0.8);
  beam->dark_noise = noise.Uniform(5, 1, 3.5);
}

void DrawRings(std::uint64_t seed, SpinningOptions* spinning) {
  const Noise noise(seed, 0, "imperfect rings");
  spinning->ring_bias_sigma_m = noise.Uniform(0, 0.003, 0.010);
  spinning->beams_meet_m = noise.Uniform(1, 0, 0.045);
}

template <typename... Values>
std::string Line(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof(line), format, values...);
  return std::string(line) + "\n";
}

bool IsOff(const BeamOptions& beam) {
  return beam.range_offset_m != 0 || beam.dark_range_m != 0 || beam.dark_noise != 1;
}

std::string BeamText(const BeamOptions& beam) {
  return Line("ranges: %+.1f mm, black ones %+.1f mm more and %.1f times as noisy",
              1e3 * beam.range_offset_m, 1e3 * beam.dark_range_m, beam.dark_noise) +
         Line("beam: %.2f mrad wide, returns from %.3f of a white wall's, merges within %.2f m",
              1e3 * beam.divergence_rad, beam.min_return, beam.merge_m);
}

std::string RingsText(const SpinningOptions& spinning, std::uint64_t seed) {
  std::string offsets;
  for (int ring = 0; ring < spinning.rings(); ++ring) {
    char offset[16];
    std::snprintf(offset, sizeof(offset), " %+.1f", 1e3 * RingBias(spinning, seed, ring));
    offsets += offset;
  }
  return "rings' ranges [mm], the lowest first:" + offsets + "\n" +
         Line("beams meet at a radius of %.1f mm", 1e3 * spinning.beams_meet_m);
}

}  // namespace

void MakeImperfect(Options* options) {
  for (CameraOptions& camera : options->cameras) DrawLens(options->seed, &camera);
  DrawPrint(options->seed, &options->board);
  DrawBeam(options->seed, &options->scanner);
  if (options->livox) DrawBeam(options->seed, &*options->livox);
  for (std::size_t i = 0; i < options->further_lidars.size(); ++i) {
    SpinningOptions* spinning = &options->further_lidars[i].spinning;
    DrawBeam(SeedOfLidar(options->seed, i), spinning);
    DrawRings(SeedOfLidar(options->seed, i), spinning);
  }
  if (!options->spinning) return;
  DrawBeam(options->seed, &*options->spinning);
  DrawRings(options->seed, &*options->spinning);
}

std::string ImperfectionsText(const Options& options) {
  std::string text;
  for (const CameraOptions& camera : options.cameras) {
    const LensNumbers& e = camera.lens_error;
    if (e.isZero(0)) continue;
    text += Line("%s: the rig file's fx %+.2f, fy %+.2f, cx %+.2f, cy %+.2f px, k1 %+.4f off",
                 camera.name.c_str(), e[0], e[1], e[2], e[3], e[4]);
  }
  const Eigen::Vector2d& print = options.board.print_scale;
  const bool has_board = !options.natural.on || options.natural.board;
  if (has_board && print != Eigen::Vector2d(1, 1)) {
    text +=
        Line("pattern: printed %.5f wide, %.5f high of what its squares say", print.x(), print.y());
  }
  const BeamOptions& beam = options.beam();
  if (IsOff(beam)) text += BeamText(beam);
  const auto& spinning = options.spinning;
  if (spinning && (spinning->ring_bias_sigma_m != 0 || spinning->beams_meet_m != 0)) {
    text += RingsText(*spinning, options.seed);
  }
  for (std::size_t i = 0; i < options.further_lidars.size(); ++i) {
    const FurtherLidarOptions& lidar = options.further_lidars[i];
    if (!IsOff(lidar.spinning)) continue;
    text += lidar.name + ":\n" + BeamText(lidar.spinning) +
            RingsText(lidar.spinning, SeedOfLidar(options.seed, i));
  }
  return text;
}

}  // namespace rgbdt::simulate
