#include "calib/fuse/blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

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

// How far sample i of this camera counts where another camera sees the point, too.
float WeightOf(const BlendCamera& camera, std::size_t i) {
  constexpr float kBorder = 0.05F;  // of the image's width: less and less from there to the border
  constexpr float kSaturated = 0.02F;
  const float u = camera.samples->u[i];
  const float v = camera.samples->v[i];
  const CameraSpec& spec = camera.camera->spec();
  const auto width = static_cast<float>(spec.width);
  const float border =
      std::min({u, v, width - 1 - u, static_cast<float>(spec.height) - 1 - v}) / (kBorder * width);
  float weight = std::min(1.0F, border);
  if (camera.surfaces != nullptr) weight *= camera.surfaces->CosineAt(u, v);
  if (IsSaturated(spec.kind, camera.samples->sample[i])) weight *= kSaturated;
  return std::max(kLeastWeight, weight);
}

// What a few points in a row become: written here, in the processor's nearest memory, and then
// once to the cloud.
struct Tile {
  static constexpr std::size_t kSize = 512;
  std::array<std::uint8_t, 3> rgb[kSize];
  float temperature_k[kSize], temperature_sigma_k[kSize], thermal_counts[kSize];
  std::uint32_t valid[kSize];

  void Clear() {
    std::memset(rgb, 0, sizeof rgb);
    std::fill_n(temperature_k, kSize, kNone);
    std::fill_n(temperature_sigma_k, kSize, kNone);
    std::fill_n(thermal_counts, kSize, kNone);
    std::fill_n(valid, kSize, 0U);
  }
};

// One camera and how far its samples have been blended.
class View {
 public:
  View(const BlendCamera& camera, std::size_t index, std::size_t first_point)
      : camera_(&camera),
        seen_(camera.samples),
        bit_(1U << index),
        next_(seen_->FirstFrom(first_point)) {}

  bool ShowsAny(std::size_t end_point) const {
    return next_ < seen_->size() && seen_->point[next_] < end_point;
  }

  // Goes to the next samples of points before `end_point` that one radiometry goes for.
  bool Next(std::size_t end_point) {
    first_ = next_;
    if (!ShowsAny(end_point)) return false;
    const auto& runs = seen_->runs;
    while (run_ + 1 < runs.size() && runs[run_ + 1].first <= first_) ++run_;
    const std::size_t run_end = run_ + 1 < runs.size() ? runs[run_ + 1].first : seen_->size();
    next_ = std::min(run_end, seen_->FirstFrom(end_point, first_));
    return true;
  }

  // Of these samples.
  std::size_t first_point() const { return seen_->point[first_]; }
  std::size_t end_point() const { return seen_->point[next_ - 1] + std::size_t{1}; }
  const TemperatureTable& temperatures() const { return *seen_->runs[run_].temperatures; }

  // By point from `begin` on: which cameras see it, and of those that this one does value(sample).
  // Returns how many are occluded from it.
  template <typename T, typename Value>
  std::int64_t Take(std::size_t begin, Value value, std::uint32_t* valid, T* values) const {
    const std::uint32_t* point = seen_->point.data();
    const std::uint32_t* sample = seen_->sample.data();
    const std::uint8_t* occluded = seen_->occluded.data();
    const std::uint32_t bit = bit_;
    std::int64_t all_occluded = 0;
    for (std::size_t s = first_; s < next_; ++s) {
      const std::size_t i = point[s] - begin;
      const bool is_occluded = occluded[s] != 0;
      valid[i] |= is_occluded ? 0U : bit;
      values[i] = is_occluded ? values[i] : value(sample[s]);
      all_occluded += is_occluded ? 1 : 0;
    }
    return all_occluded;
  }

  // take(point, its weight, sample) where it is not occluded. Returns how many are.
  template <typename Take>
  std::int64_t ForSeen(Take take) const {
    std::int64_t all_occluded = 0;
    for (std::size_t s = first_; s < next_; ++s) {
      if (seen_->occluded[s] != 0) {
        ++all_occluded;
      } else {
        take(seen_->point[s], WeightOf(*camera_, s), seen_->sample[s]);
      }
    }
    return all_occluded;
  }

  std::uint32_t bit() const { return bit_; }

 private:
  const BlendCamera* camera_;
  const PointSamples* seen_;
  std::uint32_t bit_;
  std::size_t next_, first_ = 0;  // samples
  std::size_t run_ = 0;           // of theirs
};

// Tile after tile, and in each one camera after the other; sums only where a point needs them.
class Blender {
 public:
  Blender(const std::vector<BlendCamera>& cameras, std::size_t first, std::size_t size)
      : first_(first), size_(size) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const View view(cameras[c], c, first);
      if (!view.ShowsAny(first + size)) continue;
      const bool thermal = cameras[c].camera->spec().kind == CameraKind::kThermal;
      (thermal ? thermal_ : colour_).push_back(view);
    }
  }

  Blended Run() {
    blended_.rgb.reserve(size_);
    blended_.temperature_k.reserve(size_);
    blended_.temperature_sigma_k.reserve(size_);
    blended_.thermal_counts.reserve(size_);
    blended_.valid.reserve(size_);
    for (std::size_t begin = 0; begin < size_; begin += Tile::kSize) {
      begin_ = first_ + begin;
      count_ = std::min(Tile::kSize, size_ - begin);
      tile_.Clear();
      colour_.size() == 1 ? TakeColours(&colour_[0]) : BlendColours();
      thermal_.size() == 1 ? TakeTemperatures(&thermal_[0]) : BlendTemperatures();
      Append();
    }
    return std::move(blended_);
  }

 private:
  std::size_t end() const { return begin_ + count_; }

  void TakeColours(View* view) {
    if (!view->ShowsAny(end())) return;
    std::uint32_t samples[Tile::kSize] = {};
    const auto same = [](std::uint32_t sample) { return sample; };
    while (view->Next(end())) {
      blended_.occluded += view->Take(begin_, same, tile_.valid, samples);
    }
    for (std::size_t i = 0; i < count_; ++i) tile_.rgb[i] = RgbOf(samples[i]);
  }

  void TakeTemperatures(View* view) {
    while (view->Next(end())) {
      blended_.occluded += view->Take(begin_, CountsOf, tile_.valid, tile_.thermal_counts);
      const std::size_t i = view->first_point() - begin_;
      view->temperatures().At(&tile_.thermal_counts[i], view->end_point() - begin_ - i,
                              &tile_.temperature_k[i], &tile_.temperature_sigma_k[i]);
    }
  }

  void BlendColours() {
    if (colour_.empty()) return;
    ClearSums();
    for (View& view : colour_) {
      while (view.Next(end())) {
        blended_.occluded +=
            view.ForSeen([&](std::size_t point, float weight, std::uint32_t sample) {
              const std::size_t i = point - begin_;
              const auto rgb = RgbOf(sample);
              tile_.valid[i] |= view.bit();
              weight_[i] += weight;
              for (std::size_t c = 0; c < 3; ++c)
                sums_[i][c] += weight * static_cast<float>(rgb[c]);
            });
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (!(weight_[i] > 0)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        tile_.rgb[i][c] = static_cast<std::uint8_t>(sums_[i][c] / weight_[i] + 0.5F);
      }
    }
  }

  void BlendTemperatures() {
    if (thermal_.empty()) return;
    ClearSums();
    for (View& view : thermal_) {
      while (view.Next(end())) {
        blended_.occluded +=
            view.ForSeen([&](std::size_t point, float weight, std::uint32_t sample) {
              tile_.valid[point - begin_] |= view.bit();
              AddTemperature(point - begin_, weight, CountsOf(sample), view.temperatures());
            });
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (!(weight_[i] > 0)) continue;
      tile_.temperature_k[i] = sums_[i][0] / weight_[i];
      tile_.temperature_sigma_k[i] = std::sqrt(sums_[i][1]) / weight_[i];
    }
  }

  void AddTemperature(std::size_t i, float weight, float counts, const TemperatureTable& table) {
    const auto temperature = table.At(counts);
    if (weight > best_[i]) {
      best_[i] = weight;
      tile_.thermal_counts[i] = counts;
    }
    if (std::isnan(temperature.kelvin)) return;
    // A camera of unknown noise counts like one of 0.1 K.
    const float sigma = std::isnan(temperature.sigma_k) ? 0.1F : temperature.sigma_k;
    weight /= sigma * sigma;
    weight_[i] += weight;
    sums_[i][0] += weight * temperature.kelvin;
    sums_[i][1] += weight * weight * temperature.sigma_k * temperature.sigma_k;
  }

  void ClearSums() {
    weight_.fill(0);
    best_.fill(0);
    sums_.fill({0, 0, 0});
  }

  void Append() {
    const auto append = [this](const auto* from, auto* to) {
      to->insert(to->end(), from, from + count_);
    };
    append(tile_.rgb, &blended_.rgb);
    append(tile_.temperature_k, &blended_.temperature_k);
    append(tile_.temperature_sigma_k, &blended_.temperature_sigma_k);
    append(tile_.thermal_counts, &blended_.thermal_counts);
    append(tile_.valid, &blended_.valid);
    for (std::size_t i = 0; i < count_; ++i) blended_.coloured += tile_.valid[i] != 0 ? 1 : 0;
  }

  std::size_t first_, size_;
  std::vector<View> colour_, thermal_;
  Blended blended_;

  Tile tile_;
  std::size_t begin_ = 0, count_ = 0;  // the tile's points, numbered as the samples number them
  std::array<float, Tile::kSize> weight_, best_;
  std::array<std::array<float, 3>, Tile::kSize> sums_;
};

}  // namespace

Blended Blend(const std::vector<BlendCamera>& cameras, std::size_t first, std::size_t size) {
  return Blender(cameras, first, size).Run();
}

}  // namespace rgbdt
