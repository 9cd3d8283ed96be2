#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// The beams of one ring in the LIDAR's frame.
class Ring {
 public:
  /// `options` live longer.
  Ring(const SpinningOptions& options, int index);

  int index() const { return index_; }
  int columns() const { return columns_; }
  /// Where they all start.
  const Eigen::Vector3d& start() const { return start_; }
  /// When a column's fires, after the revolution's begin.
  Utime FiredAfter(int column) const;
  /// Unit, of a column's middle.
  Eigen::Vector3d Direction(int column) const;
  /// Unit; they fill a column's beam, the middle first.
  std::vector<Eigen::Vector3d> SubRays(int column) const;

 private:
  /// Rings of one column fire at these places on the way to the next column, in steps.
  double Place(int column) const;
  double Azimuth(int column) const;

  const SpinningOptions& options_;
  int index_;
  int columns_;
  Eigen::Vector3d along_, start_;
  std::vector<Eigen::Vector3d> sub_rays_;
};

/// What a ring's beams bring back, one a column, without noise. Called by several threads.
using CastRing = std::function<std::vector<BeamReturn>(const Ring& ring)>;

/// One revolution of a spinning LIDAR: an organised cloud, ring x azimuth (lines are rings, the
/// lowest first; beams are azimuths, from `first_azimuth_rad` on), each point as the LIDAR saw it
/// at its time. A miss is NaN and keeps its direction. Noise is a function of (seed, utime) only, a
/// ring's bias of the seed. `threads` 0: as many as the machine has, the result is the same.
Cloud SpinningSweep(const SpinningOptions& options, std::uint64_t seed, Utime utime, int threads,
                    const CastRing& cast);

/// Of a LIDAR that stands where `world_from_lidar` puts it.
std::vector<BeamReturn> CastStanding(const World& world, const SpinningOptions& options,
                                     const Ring& ring, const Rigid3& world_from_lidar = {});

/// Of a LIDAR that stands where `world_from_lidar` puts it.
Cloud SpinningSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                    Utime utime, int threads = 0, const Rigid3& world_from_lidar = {});

/// Of one that moves while it turns: each beam starts from where it is at the beam's time.
Cloud MovingSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                  Utime utime, const std::function<Rigid3(Utime)>& world_from_lidar,
                  int threads = 0);

/// The constant bias [m] of a ring's ranges.
double RingBias(const SpinningOptions& options, std::uint64_t seed, int ring);

}  // namespace rgbdt::simulate
