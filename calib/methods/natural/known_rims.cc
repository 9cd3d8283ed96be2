#include "calib/methods/natural/known_rims.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace rgbdt {
namespace {

using Eigen::Vector3d;

constexpr double kCellM = 0.5;
constexpr double kApartM = 0.1;  // of a rim's edges that are kept

// Across the rim, to where the nearer surface has ended.
Vector3d Outwards(const SceneEdge& edge) {
  return edge.across - edge.across.dot(edge.along) * edge.along;
}

// 1 sigma of the error that a rim's edges have in common, from the places between beams that it
// runs through: it averages their errors.
double CommonRad(const std::vector<const SceneEdge*>& edges) {
  double aside_rad = 0;
  std::set<int> places;
  for (const SceneEdge* edge : edges) {
    aside_rad += Outwards(*edge).norm() / edge->point.norm();
    places.insert(edge->place);
  }
  return aside_rad / static_cast<double>(edges.size()) / std::sqrt(3.0) /
         static_cast<double>(places.size());
}

}  // namespace

KnownRims::Cell KnownRims::CellOf(int world, const Vector3d& point) {
  Cell cell{world, 0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = std::floor(point[static_cast<Eigen::Index>(k)] / kCellM);
    cell[k + 1] = static_cast<std::int64_t>(std::clamp(at, -1e12, 1e12));
  }
  return cell;
}

// The rim of earlier shots near which most of these edges lie, if many do; -1: none.
int KnownRims::Find(int world, const std::vector<Seen>& edges) const {
  constexpr std::size_t kAsked = 40;
  constexpr double kMany = 0.3;  // of those that are asked: as much of a rim is hidden elsewhere
  const std::size_t every = 1 + edges.size() / kAsked;
  std::map<int, int> votes;
  int asked = 0;
  for (std::size_t i = 0; i < edges.size(); i += every) {
    ++asked;
    const Seen& own = edges[i];
    const auto reach = static_cast<int>(std::ceil(own.near_m / kCellM));
    std::set<int> met;
    for (int k = 0; k < (2 * reach + 1) * (2 * reach + 1) * (2 * reach + 1); ++k) {
      const int side = 2 * reach + 1;
      Cell cell = CellOf(world, own.point);
      cell[1] += k % side - reach;
      cell[2] += k / side % side - reach;
      cell[3] += k / side / side - reach;
      const auto there = seen_.find(cell);
      if (there == seen_.end()) continue;
      for (const Seen& other : there->second) {
        const bool same =
            (other.point - own.point).norm() < own.near_m && other.outwards.dot(own.outwards) > 0.5;
        if (same) met.insert(other.rim);
      }
    }
    for (const int rim : met) ++votes[rim];
  }
  const auto best = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return best != votes.end() && best->second >= kMany * asked ? best->first : -1;
}

void KnownRims::Keep(int world, const Seen& edge) {
  std::vector<Seen>& cell = seen_[CellOf(world, edge.point)];
  const bool known = std::any_of(cell.begin(), cell.end(), [&](const Seen& other) {
    return other.rim == edge.rim && (other.point - edge.point).norm() < kApartM;
  });
  if (!known) cell.push_back(edge);
}

// From one place the same beams meet a rim time and again: their error is one and the same.
int KnownRims::StationOf(const ShotPlace& place) {
  constexpr double kSameM = 0.02, kSameRad = 2e-3;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const Rigid3& known = stations_[i].world_from_lidar;
    if (stations_[i].world == place.world &&
        (known.translation - place.world_from_lidar.translation).norm() < kSameM &&
        RotationDistance(known, place.world_from_lidar) < kSameRad) {
      return static_cast<int>(i);
    }
  }
  stations_.push_back(place);
  return static_cast<int>(stations_.size() - 1);
}

std::vector<int> KnownRims::Add(const std::vector<SceneEdge>& edges, const ShotPlace& taken_at) {
  const Rigid3& world_from_lidar = taken_at.world_from_lidar;
  const int station = StationOf(taken_at);
  std::map<int, std::vector<const SceneEdge*>> own;
  for (const SceneEdge& edge : edges) own[edge.rim].push_back(&edge);
  std::map<int, int> numbers, things;
  std::vector<Seen> all;
  for (const auto& [number, of_rim] : own) {
    std::vector<Seen> seen;
    for (const SceneEdge* edge : of_rim) {
      // A round thing's rim is another line of it from elsewhere.
      seen.push_back({world_from_lidar * edge->point,
                      world_from_lidar.rotation * Outwards(*edge).normalized(),
                      0.05 + 0.02 * edge->point.norm(), -1});
    }
    int rim = Find(taken_at.world, seen);
    if (rim < 0) {
      rim = static_cast<int>(thing_of_.size());
      thing_of_.push_back(-1);
    }
    const auto [met, is_new] = met_.try_emplace({station, rim}, static_cast<int>(rims_.size()));
    if (is_new) rims_.push_back({CommonRad(of_rim), rim, -1});
    numbers[number] = met->second;
    for (Seen& edge : seen) edge.rim = rim;
    all.insert(all.end(), seen.begin(), seen.end());
  }
  for (const Seen& edge : all) Keep(taken_at.world, edge);
  // A thing is called as the first of its rims.
  std::vector<int> out;
  out.reserve(edges.size());
  for (const SceneEdge& edge : edges) {
    SceneRim& met = rims_[static_cast<std::size_t>(numbers[edge.rim])];
    int& thing = thing_of_[static_cast<std::size_t>(met.rim)];
    if (thing < 0) thing = things.emplace(edge.thing, met.rim).first->second;
    things.emplace(edge.thing, thing);
    met.thing = thing;
    out.push_back(numbers[edge.rim]);
  }
  return out;
}

}  // namespace rgbdt
