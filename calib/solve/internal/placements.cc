#include "calib/solve/internal/placements.h"

#include <algorithm>
#include <cmath>

#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

constexpr double kShared = 0.25;

bool IsSamePlace(const Rigid3& a, const Rigid3& b) {
  constexpr double kSameM = 0.010, kPerMetre = 0.003, kSameRad = 0.3 * M_PI / 180;
  const double same_m = std::max(kSameM, kPerMetre * a.translation.norm());
  const auto turned = [&](const Rigid3& other) {
    return a.rotation.angularDistance(other.rotation);
  };
  return (a.translation - b.translation).norm() < same_m &&
         std::min(turned(b), turned(b * kHalfTurn)) < kSameRad;
}

}  // namespace

Placements PlacementsOf(const std::vector<Rigid3>& lidar_from_target) {
  std::vector<std::vector<const Rigid3*>> places;
  for (const Rigid3& pose : lidar_from_target) {
    const auto same = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return IsSamePlace(*place.front(), pose);
    });
    if (same == places.end()) {
      places.push_back({&pose});
    } else {
      same->push_back(&pose);
    }
  }
  double squares = 0;
  for (const auto& place : places) squares += std::pow(static_cast<double>(place.size()), 2);
  Placements out;
  out.places = static_cast<int>(places.size());
  if (out.places > 0) {
    out.factor = 1 + kShared * (squares / static_cast<double>(lidar_from_target.size()) - 1);
  }
  return out;
}

}  // namespace rgbdt
