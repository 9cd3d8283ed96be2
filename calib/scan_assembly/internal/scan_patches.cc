#include "calib/scan_assembly/internal/scan_patches.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr int kFinest = 6;
constexpr std::size_t kLeastBeams = 12;  // of a half
constexpr double kQuarterPi = 0.78539816339744831;

struct Placed {
  std::uint32_t code, beam;

  bool operator<(const Placed& other) const {
    return code != other.code ? code < other.code : beam < other.beam;
  }
};

// Of a direction's tile: sweep, face of the cube, then two bits a level.
std::uint32_t CodeOf(const Eigen::Vector3d& direction, int sweep) {
  Eigen::Index axis;
  direction.cwiseAbs().maxCoeff(&axis);
  const double along = direction[axis];
  const auto place = [&](Eigen::Index other) {
    const double share = 0.5 * (1 + std::atan(direction[other] / along) / kQuarterPi);
    return static_cast<std::uint32_t>(std::clamp(share, 0.0, 0.999999) * (1 << kFinest));
  };
  const std::uint32_t u = place((axis + 1) % 3), v = place((axis + 2) % 3);
  auto code = static_cast<std::uint32_t>(sweep * 6 + 2 * axis + (along > 0 ? 1 : 0));
  for (int bit = kFinest - 1; bit >= 0; --bit) {
    code = code << 2 | ((u >> bit) & 1) << 1 | ((v >> bit) & 1);
  }
  return code;
}

std::vector<Placed> InTiles(const PlacedBeams& all) {
  std::vector<Placed> placed;
  placed.reserve(all.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    placed.push_back({CodeOf(all.Point(i) - all.centre(), all.sweep(i)), i});
  }
  std::sort(placed.begin(), placed.end());
  return placed;
}

using Tile = std::pair<const Placed*, const Placed*>;

// The tiles of a level among those of a coarser one.
template <typename Visit>
void ForEachTile(Tile tile, int level, const Visit& visit) {
  const int shift = 2 * (kFinest - level);
  for (const Placed* begin = tile.first; begin != tile.second;) {
    const Placed* end = std::find_if(begin, tile.second, [&](const Placed& placed) {
      return placed.code >> shift != begin->code >> shift;
    });
    visit(Tile{begin, end});
    begin = end;
  }
}

BeamList HalfOf(const PlacedBeams& all, Tile tile, bool behind) {
  BeamList beams;
  for (const Placed* placed = tile.first; placed != tile.second; ++placed) {
    if (all.behind(placed->beam) == behind) beams.push_back(placed->beam);
  }
  return beams;
}

void JoinPlanes(const PlacedBeams& all, double sigma_m, ScanPatch* patch) {
  BeamPlane& joint = patch->joint;
  if (patch->before.normal.dot(patch->behind.normal) < 0) patch->behind.normal *= -1;
  joint.normal = (patch->before.normal + patch->behind.normal).normalized();
  joint.centre = 0.5 * (patch->before.centre + patch->behind.centre);
  joint.beams = patch->before.beams;
  joint.beams.insert(joint.beams.end(), patch->behind.beams.begin(), patch->behind.beams.end());
  RefitPlane(all, sigma_m, &joint);
  const auto below = [&](const BeamPlane& half) {
    return half.normal.dot(joint.centre - half.centre) / half.normal.dot(joint.normal);
  };
  patch->gap_m = below(patch->behind) - below(patch->before);
}

class Search {
 public:
  Search(const PlacedBeams& all, const PatchSearch& search, PatchList* found)
      : all_(all), search_(search), found_(found) {}

  void Visit(Tile tile, int level) {
    const BeamList before = HalfOf(all_, tile, false), behind = HalfOf(all_, tile, true);
    const bool twice = std::min(before.size(), behind.size()) >= kLeastBeams;
    if (level == search_.first_level && std::max(before.size(), behind.size()) >= kLeastBeams) {
      ++found_->tiles;
      found_->tiles_twice += twice;
    }
    if (!twice) return;
    if (auto patch = PatchOf(before, behind)) {
      found_->patches.push_back(std::move(*patch));
    } else if (level < search_.last_level) {
      ForEachTile(tile, level + 1, [&](Tile part) { Visit(part, level + 1); });
    }
  }

 private:
  std::optional<ScanPatch> PatchOf(const BeamList& before, const BeamList& behind) const {
    auto plane_before = FitPlane(all_, before, search_.sigma_m, search_.slack);
    if (!plane_before) return std::nullopt;
    auto plane_behind = FitPlane(all_, behind, search_.sigma_m, search_.slack);
    if (!plane_behind) return std::nullopt;
    ScanPatch patch;
    patch.before = std::move(*plane_before);
    patch.behind = std::move(*plane_behind);
    const double alike = std::abs(patch.before.normal.dot(patch.behind.normal));
    if (alike < std::cos(search_.max_turn_rad)) return std::nullopt;
    JoinPlanes(all_, search_.sigma_m, &patch);
    if (!(std::abs(patch.gap_m) < search_.max_gap_m)) return std::nullopt;
    return patch;
  }

  const PlacedBeams& all_;
  const PatchSearch& search_;
  PatchList* found_;
};

}  // namespace

PatchList FindPatches(const PlacedBeams& all, const PatchSearch& search) {
  const std::vector<Placed> placed = InTiles(all);
  PatchList found;
  Search visitor(all, search, &found);
  ForEachTile({placed.data(), placed.data() + placed.size()}, search.first_level,
              [&](Tile tile) { visitor.Visit(tile, search.first_level); });
  return found;
}

void RefitPatch(const PlacedBeams& all, double sigma_m, ScanPatch* patch) {
  RefitPlane(all, sigma_m, &patch->before);
  RefitPlane(all, sigma_m, &patch->behind);
  JoinPlanes(all, sigma_m, patch);
}

double RangeNoise(const PlacedBeams& all) {
  constexpr int kLevel = 4;  // some 6 degrees: what a wrong geometry bends is far below the noise
  constexpr double kFlat = 0.4;       // so many of the pieces are taken to be flat
  constexpr double kGenerous = 0.04;  // [m] sigma: the noise is not to be cut short
  const std::vector<Placed> placed = InTiles(all);
  std::vector<double> variances;
  ForEachTile({placed.data(), placed.data() + placed.size()}, kLevel, [&](Tile tile) {
    for (const bool behind : {false, true}) {
      if (const auto plane = FitPlane(all, HalfOf(all, tile, behind), kGenerous, 1)) {
        variances.push_back(plane->chi2 / plane->dof() * kGenerous * kGenerous);
      }
    }
  });
  if (variances.empty()) return 0;
  const auto place = static_cast<std::size_t>(kFlat * static_cast<double>(variances.size()));
  return std::sqrt(Nth(std::move(variances), place));
}

}  // namespace rgbdt
