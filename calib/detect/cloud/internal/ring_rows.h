#pragma once

#include <optional>
#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/model/cloud.h"

namespace rgbdt {

/// A LIDAR with more beams above each other is a turned scanner: its centre moves.
inline constexpr std::size_t kMostRings = 200;

/// The hits of a cloud, in its order; none at the sensor's very origin.
std::vector<RangeGrid::Angles> AnglesOf(const Cloud& cloud);

/// The rings of a LIDAR that its cloud shows: lowest first, by azimuth, one return a beam.
struct RingRows {
  RangeGrid::Rows rows;
  /// The cloud has ring numbers, and they are not those of its rings: the rows go by elevation.
  bool misnumbered = false;
  /// The part of the points that seem to be of further turns which could not be told apart.
  double shared = 0;
};

/// By the cloud's ring numbers, where those keep to an elevation, or else by the elevations that
/// the points keep to. Of points at one azimuth of a ring (two returns, doubled points) the
/// brightest is kept, the first of equals; of further turns in the same cloud only what the first
/// one left out; all, where that would leave out 2% or less, as of a turn that overlaps itself.
/// Nothing: the points keep to no rings, or to more than kMostRings.
std::optional<RingRows> FindRingRows(const Cloud& cloud,
                                     const std::vector<RangeGrid::Angles>& angles);

/// Whether points lie in rows, as a spinning LIDAR's do, whose beams are closer together along a
/// ring than its rings are.
bool LieInRows(const std::vector<RangeGrid::Angles>& angles);

/// Median elevation of points [rad].
double MedianElevation(const std::vector<RangeGrid::Angles>& row);

}  // namespace rgbdt
