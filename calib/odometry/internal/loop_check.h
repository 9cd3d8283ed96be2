#pragma once

#include <string>
#include <vector>

#include "calib/odometry/internal/keyframes.h"

namespace rgbdt::odometry {

/// Whether a keyframe's sweep lies on the map about an earlier one, and where.
struct LoopCheck {
  std::string why_not;  ///< empty: it does
  Rigid3 old_from_new;
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta in new's axes, see PoseEdge
  double overlap = 0;                      ///< share of the new sweep's points that lie on planes
  double fit = 0;                          ///< of these, within 0.1 m of their plane
  double residual_m = 0;                   ///< median distance of these
};

/// Registers `frame` on `map`, which is about another keyframe, in that one's axes, from each of
/// the starts (old_from_new) until it lies there by all that is asked; else the best of what was
/// found, with the reason.
LoopCheck CheckLoop(const PlaneMap& map, const Keyframe& frame, const std::vector<Rigid3>& starts,
                    const OdometryOptions& options);

}  // namespace rgbdt::odometry
