#include "calib/present/report/comparison_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostAxes = 2;  // in a sentence

struct Axis {
  Estimate estimate;
  int decimals;
  std::string unit, name;
  double Sigmas() const { return std::abs(estimate.value) / estimate.sigma; }
};

// Along which the two differ beyond doubt, the clearest first, or else the clearest one.
std::vector<Axis> TellingAxes(const PoseComparison& camera) {
  std::vector<Axis> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name(1, "xyz"[k]);
    axes.push_back({camera.rotation_deg[k], 3, "deg", "about the camera's " + name});
    axes.push_back({camera.centre_mm[k], 1, "mm", "along the LIDAR's " + name});
  }
  std::stable_sort(axes.begin(), axes.end(),
                   [](const Axis& a, const Axis& b) { return a.Sigmas() > b.Sigmas(); });
  std::size_t telling = 1;
  while (telling < kMostAxes && axes[telling].Sigmas() > kTellingSigmas) ++telling;
  axes.resize(telling);
  return axes;
}

// How far apart colours lie, at the distance where that is the farthest beyond what is stated.
std::string LensesDiffer(const PoseComparison& camera) {
  const auto& worst = *std::max_element(
      camera.pixels.begin(), camera.pixels.end(), [](const PixelShift& a, const PixelShift& b) {
        return a.rms_px / a.sigma_px.value_or(HUGE_VAL) < b.rms_px / b.sigma_px.value_or(HUGE_VAL);
      });
  return fmt::format(
      "; but the lenses differ: colours at {:.0f} m lie {:.1f} px apart (RMS over the image), "
      "where "
      "{:.1f} px are stated. Where a session has no board in the image, its lens is a guess: find "
      "it "
      "from images that cover all of it (rgbdt intrinsics), and calibrate both again",
      worst.distance_m, worst.rms_px, worst.sigma_px.value_or(0));
}

std::string Words(const PoseComparison& camera, const CalibrationComparison& all) {
  if (!camera.chi2) {
    return fmt::format(
        "{:.3f} deg and {:.1f} mm apart; whether that is more than chance cannot be told, as not "
        "both calibrations have converged with an uncertainty",
        camera.difference.rotation_deg, camera.difference.translation_mm);
  }
  const double chance = ChanceOfChi2(*camera.chi2);
  if (!Moved(camera)) {
    return fmt::format("the same {}within what both can tell (chi-square {:.1f} of 6){}",
                       ColoursMoved(camera) ? "pose " : "", *camera.chi2,
                       ColoursMoved(camera) ? LensesDiffer(camera) : "");
  }
  std::string moved;
  for (const Axis& axis : TellingAxes(camera)) {
    moved +=
        fmt::format("{}{:+.{}f} +- {:.{}f} {} {}", moved.empty() ? "" : ", ", axis.estimate.value,
                    axis.decimals, axis.estimate.sigma, axis.decimals, axis.unit, axis.name);
  }
  const bool later = IsDate(all.utime_a) && all.utime_a < all.utime_b;
  return fmt::format(
      "the mount moved by {}{} (chi-square {:.1f} of 6, by chance {})", moved,
      later ? " since " + TimeText(all.utime_a) : "", *camera.chi2,
      chance < 1e-6 ? "less than once in a million" : fmt::format("once in {:.0f}", 1 / chance));
}

std::string Figure(const Estimate& estimate, int decimals) {
  const std::string value = fmt::format("{:+.{}f}", estimate.value, decimals);
  return std::isfinite(estimate.sigma)
             ? fmt::format("{} +- {:.{}f}", value, estimate.sigma, decimals)
             : value;
}

std::string AxesLine(const std::string& label, const std::array<Estimate, 3>& axes, int decimals) {
  std::string line = fmt::format("  {:<42}", label);
  for (const Estimate& axis : axes) line += fmt::format("{:>20}", Figure(axis, decimals));
  return line + "\n";
}

std::string PixelsLine(const std::vector<PixelShift>& pixels) {
  std::string label = "colours at";
  std::string line;
  for (const PixelShift& at : pixels) {
    label += fmt::format("{} {:.0f}", line.empty() ? "" : ",", at.distance_m);
    const std::string sigma = at.sigma_px ? fmt::format(" +- {:.2f}", *at.sigma_px) : "";
    line += fmt::format("{:>20}", fmt::format("{:.2f}{}", at.rms_px, sigma));
  }
  return fmt::format("  {:<42}{}\n", label + " m, RMS over the image [px]", line);
}

}  // namespace

std::string ComparisonText(const CalibrationComparison& comparison) {
  std::string text = fmt::format("{} against {}\n", comparison.b, comparison.a);
  if (!comparison.same_rig) {
    text += "  the rig files differ" +
            (comparison.rigs_differ.empty() ? "" : " (" + comparison.rigs_differ + ")") +
            ": where lens or board do, so may the poses\n";
  }
  if (!comparison.not_compared.empty()) text += "  " + comparison.not_compared + "\n";
  for (const PoseComparison& camera : comparison.cameras) {
    text += fmt::format("{}: {}\n", camera.camera, Words(camera, comparison));
    text += AxesLine("rotation about the camera's x, y, z [deg]", camera.rotation_deg, 3);
    text += AxesLine("centre along the LIDAR's x, y, z [mm]", camera.centre_mm, 1);
    if (!camera.pixels.empty()) text += PixelsLine(camera.pixels);
  }
  return text;
}

}  // namespace rgbdt
