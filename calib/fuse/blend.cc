#include "calib/fuse/blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kLeastWeight = 1e-3F;  // a bad view of a point is better than none

std::array<std::uint8_t, 3> RgbOf(std::uint32_t sample) {
  return {static_cast<std::uint8_t>(sample), static_cast<std::uint8_t>(sample >> 8),
          static_cast<std::uint8_t>(sample >> 16)};
}

bool IsSaturated(CameraKind kind, std::uint32_t sample) {
  if (kind == CameraKind::kThermal) {
    const float counts = CountsOf(sample);
    return counts < 1 || counts > 65534;
  }
  const auto rgb = RgbOf(sample);
  return std::max({rgb[0], rgb[1], rgb[2]}) > 250;
}

// How far sighting i of this camera counts where another camera sees the point, too.
float WeightOf(const BlendCamera& camera, std::size_t i) {
  constexpr float kBorder = 0.05F;  // of the image's width: less and less from there to the border
  constexpr float kSaturated = 0.02F;
  const float u = camera.sightings->u[i];
  const float v = camera.sightings->v[i];
  const CameraSpec& spec = camera.camera->spec();
  const auto width = static_cast<float>(spec.width);
  const float border =
      std::min({u, v, width - 1 - u, static_cast<float>(spec.height) - 1 - v}) / (kBorder * width);
  float weight = std::min(1.0F, border);
  if (camera.surfaces != nullptr) weight *= camera.surfaces->CosineAt(u, v);
  if (IsSaturated(spec.kind, camera.sightings->sample[i])) weight *= kSaturated;
  return std::max(kLeastWeight, weight);
}

// One camera after the other over the same points; sums only where a point needs them.
class Blender {
 public:
  Blender(const std::vector<BlendCamera>& cameras, std::size_t first, RgbdtCloud* fused)
      : cameras_(cameras), first_(first), fused_(*fused) {
    fused_.rgb.assign(fused_.size(), {0, 0, 0});
    fused_.temperature_k.assign(fused_.size(), kNone);
    fused_.temperature_sigma_k.assign(fused_.size(), kNone);
    fused_.thermal_counts.assign(fused_.size(), kNone);
    fused_.valid.assign(fused_.size(), 0);
  }

  BlendCounts Run() {
    for (const CameraKind kind : {CameraKind::kColor, CameraKind::kThermal}) AddKind(kind);
    counts_.coloured = std::count_if(fused_.valid.begin(), fused_.valid.end(),
                                     [](std::uint32_t valid) { return valid != 0; });
    return counts_;
  }

 private:
  void AddKind(CameraKind kind) {
    std::vector<std::size_t> of_kind;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const BlendCamera& camera = cameras_[c];
      if (camera.sightings != nullptr && camera.camera->spec().kind == kind) of_kind.push_back(c);
    }
    if (of_kind.size() == 1) {
      const std::vector<std::uint32_t>& samples = cameras_[of_kind[0]].sightings->sample;
      ForSeen(of_kind[0], [&](std::size_t i, std::size_t s, const TemperatureTable* table) {
        kind == CameraKind::kThermal ? SetThermal(i, samples[s], table) : SetColour(i, samples[s]);
      });
      return;
    }
    if (of_kind.empty()) return;
    weight_.assign(fused_.size(), 0);
    best_.assign(fused_.size(), 0);
    sums_.assign(fused_.size(), {0, 0, 0});
    for (const std::size_t c : of_kind) {
      ForSeen(c, [&](std::size_t i, std::size_t s, const TemperatureTable* table) {
        const float weight = WeightOf(cameras_[c], s);
        const std::uint32_t sample = cameras_[c].sightings->sample[s];
        kind == CameraKind::kThermal ? AddThermal(i, weight, sample, table)
                                     : AddColour(i, weight, sample);
      });
    }
    for (std::size_t i = 0; i < fused_.size(); ++i) {
      if (weight_[i] > 0) kind == CameraKind::kThermal ? CloseThermal(i) : CloseColour(i);
    }
  }

  // Sightings with nothing in the way: take(point of the cloud, sighting, its radiometry).
  template <typename Take>
  void ForSeen(std::size_t index, Take take) {
    const BlendCamera& camera = cameras_[index];
    const Sightings& sightings = *camera.sightings;
    const std::uint32_t bit = 1U << index;
    const auto begin = std::lower_bound(sightings.point.begin(), sightings.point.end(), first_);
    std::size_t run = 0;
    for (auto s = static_cast<std::size_t>(begin - sightings.point.begin());
         s < sightings.size() && sightings.point[s] < first_ + fused_.size(); ++s) {
      if (sightings.hidden[s] != 0) {
        ++counts_.hidden;
        continue;
      }
      while (sightings.runs[run].end <= s) ++run;
      const std::size_t i = sightings.point[s] - first_;
      fused_.valid[i] |= bit;
      take(i, s, sightings.runs[run].temperatures.get());
    }
  }

  void SetColour(std::size_t i, std::uint32_t sample) { fused_.rgb[i] = RgbOf(sample); }

  void SetThermal(std::size_t i, std::uint32_t sample, const TemperatureTable* table) {
    const float counts = CountsOf(sample);
    const auto temperature = table->At(counts);
    fused_.thermal_counts[i] = counts;
    fused_.temperature_k[i] = temperature.kelvin;
    fused_.temperature_sigma_k[i] = temperature.sigma_k;
  }

  void AddColour(std::size_t i, float weight, std::uint32_t sample) {
    const auto rgb = RgbOf(sample);
    weight_[i] += weight;
    for (std::size_t c = 0; c < 3; ++c) sums_[i][c] += weight * static_cast<float>(rgb[c]);
  }

  void CloseColour(std::size_t i) {
    for (std::size_t c = 0; c < 3; ++c) {
      fused_.rgb[i][c] = static_cast<std::uint8_t>(sums_[i][c] / weight_[i] + 0.5F);
    }
  }

  void AddThermal(std::size_t i, float weight, std::uint32_t sample,
                  const TemperatureTable* table) {
    const float counts = CountsOf(sample);
    const auto temperature = table->At(counts);
    if (weight > best_[i]) {
      best_[i] = weight;
      fused_.thermal_counts[i] = counts;
    }
    if (std::isnan(temperature.kelvin)) return;
    // A camera of unknown noise counts like one of 0.1 K.
    const float sigma = std::isnan(temperature.sigma_k) ? 0.1F : temperature.sigma_k;
    weight /= sigma * sigma;
    weight_[i] += weight;
    sums_[i][0] += weight * temperature.kelvin;
    sums_[i][1] += weight * weight * temperature.sigma_k * temperature.sigma_k;
  }

  void CloseThermal(std::size_t i) {
    fused_.temperature_k[i] = sums_[i][0] / weight_[i];
    fused_.temperature_sigma_k[i] = std::sqrt(sums_[i][1]) / weight_[i];
  }

  const std::vector<BlendCamera>& cameras_;
  std::size_t first_;
  RgbdtCloud& fused_;
  BlendCounts counts_;
  std::vector<float> weight_, best_;
  std::vector<std::array<float, 3>> sums_;
};

}  // namespace

BlendCounts Blend(const std::vector<BlendCamera>& cameras, std::size_t first, RgbdtCloud* fused) {
  return Blender(cameras, first, fused).Run();
}

}  // namespace rgbdt
