#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/statistics.h"

namespace rgbdt {

/// What a LIDAR's ranges and beams are off by, as a solve found it. Offsets are true less measured
/// and add up; each with 1 sigma.
struct RangeErrors {
  struct OfRing {
    int ring = 0;
    Estimate offset_m;
  };
  struct OfIntensity {
    double log2_intensity = 0;  ///< between two of these the offset is interpolated
    Estimate offset_m;
  };
  Estimate offset_m;          ///< of all ranges
  std::vector<OfRing> rings;  ///< further, of each ring, rising; empty: rings agree
  std::vector<OfIntensity>
      intensities;  ///< further, by brightness, rising; empty: it does not count
  /// A spinning LIDAR's beams leave its axis (z) at heights that differ by elevation e, and meet in
  /// one height at this radius: they start at z = -beams_meet_m tan(e), where the cloud has them
  /// start in the origin.
  Estimate beams_meet_m;

  bool operator==(const RangeErrors& other) const;
};

/// No spinning LIDAR has more.
inline constexpr int kMostLasers = 256;

/// Whether `ring` names lasers: a turned scanner's only one leaves its beams' numbers there.
bool NamesLasers(const Cloud& cloud);

/// Of an intensity of 0 to 1, the logarithm to base 2, no less than kLeastLog2Intensity: 1 of
/// 65535, of which some LIDARs use the lowest hundreds alone.
inline constexpr double kLeastLog2Intensity = -16;
double Log2Intensity(double intensity);

/// Where a value lies between places one apart: it is (1 - share) of `lower` and share of the next.
struct OctavePlace {
  std::size_t lower = 0;
  double share = 0;
};
/// `first` is the first of `count` places; beyond the ends the value is that at the end.
OctavePlace PlaceOf(double value, double first, std::size_t count);

/// How much farther along its beam [m] a point lies than it was measured, but for beams_meet_m.
double RangeOffset(const RangeErrors& errors, const Cloud& cloud, std::size_t i);

/// The cloud with its points where they truly are. Directions of misses stay.
[[nodiscard]] Cloud Corrected(Cloud cloud, const RangeErrors& errors);

}  // namespace rgbdt
