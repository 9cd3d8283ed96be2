#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt::odometry {

/// What is known of the way from one pose to another.
struct PoseEdge {
  std::size_t from = 0, to = 0;
  Rigid3 from_from_to;  ///< as measured
  /// Of delta in the axes of `to`, truth = from_from_to * Exp(delta).
  Matrix6d covariance = Matrix6d::Identity();
};

/// from_from_to over one edge and a next one, with its covariance, as if both were independent.
PoseEdge Chained(const PoseEdge& first, const PoseEdge& second);

/// to_from_from, with its covariance.
PoseEdge Inverted(const PoseEdge& edge);

/// By how much two measurements of one way differ, squared over both covariances: 6 expected.
double ChiSquare(const PoseEdge& a, const PoseEdge& b);

struct SolvedGraph {
  std::vector<Rigid3> poses;      ///< world_from_pose, the first where it was
  std::vector<std::size_t> kept;  ///< numbers of the loops that fit the rest
};

/// The poses that fit a chain (edges from each pose to the next one) and the loops best, by least
/// squares over the covariances. First with robust weights on the loops (Cauchy), so that those
/// that contradict what most of them say do not bend the way: these are left out. Then without, and
/// of loops that still contradict the rest, worst first, each is left out, and all is solved again.
/// Nothing where there is no solution. Throws InputError for an edge to a
/// pose that is not there.
std::optional<SolvedGraph> SolveGraph(const std::vector<Rigid3>& start,
                                      const std::vector<PoseEdge>& chain,
                                      const std::vector<PoseEdge>& loops);

}  // namespace rgbdt::odometry
