#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "calib/methods/natural/depth_edges.h"
#include "calib/model/shot.h"

namespace rgbdt {

/// A rim as it was met from one place.
struct SceneRim {
  double common_rad = 0;  ///< 1 sigma of what its edges' places between their beams have in common
  int rim = 0;            ///< the same number for the same rim, met from wherever
  int thing = 0;          ///< the same number for rims of the same thing
};

/// Which rims of several shots are the same one: what an image shows of a rim is wrong in all of
/// them alike, so that it tells hardly more ten times than once. A rim is known again by its place
/// in the world and the side to which it ends.
class KnownRims {
 public:
  /// Of each edge of the next shot, which was taken there, an index of rims().
  std::vector<int> Add(const std::vector<SceneEdge>& edges, const ShotPlace& taken_at);
  const std::vector<SceneRim>& rims() const { return rims_; }

 private:
  using Cell = std::array<std::int64_t, 4>;
  struct Seen {
    Eigen::Vector3d point, outwards;  // world
    double near_m;                    // so far away it is still the same rim
    int rim;
  };

  static Cell CellOf(int world, const Eigen::Vector3d& point);
  int Find(int world, const std::vector<Seen>& edges) const;
  void Keep(int world, const Seen& edge);
  int StationOf(const ShotPlace& place);

  std::vector<SceneRim> rims_;
  std::vector<int> thing_of_;               // by rim
  std::vector<ShotPlace> stations_;         // from which the same beams meet a rim
  std::map<std::pair<int, int>, int> met_;  // by station and rim: an index of rims_
  std::map<Cell, std::vector<Seen>> seen_;
};

}  // namespace rgbdt
