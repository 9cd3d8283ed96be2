#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/detect/image/internal/edge_profiles.h"

namespace rgbdt {

/// A straight displacement of a curve onto an edge: it falls linearly from `first_px` at the
/// curve's start to `last_px` at its end.
struct SideLine {
  double first_px = 0, last_px = 0;
  /// Of these two [px^2], by the residuals themselves: neighbouring profiles share noise and what
  /// the background does, so their correlation is counted (Newey and West 1987).
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double share = 0;         ///< of the profiles inside the image, those that lie on it
  double edge_share = 0;    ///< of the profiles inside the image, those that show any edge
  int count = 0;            ///< profiles that lie on it
  double rms_px = 0;        ///< of their residuals
  double dark_share = 0;    ///< of these, those beside which the image is clipped at black
  double bright_share = 0;  ///< and those beside which it is saturated
};

/// The line with the most support among all edges of all profiles, then a robust fit to the edges
/// nearest to it. `length_px` is the curve's, `correlation_px` how far along it residuals may be
/// alike. Displacements lie between `inner_px` and `outer_px`.
SideLine FitSideLine(const std::vector<Profile>& profiles, double length_px, double inner_px,
                     double outer_px, double correlation_px);

}  // namespace rgbdt
