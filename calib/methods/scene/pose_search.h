#pragma once

#include <functional>
#include <string>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// What a method without a target makes as large as it can: how well clouds and images agree.
using PoseObjective = std::function<double(const Rigid3& camera_from_lidar)>;

/// A length for each of delta's six components (rigid3.h): a step, or half the width of a box.
struct PoseSteps {
  double rotation_rad = 0;
  double translation_m = 0;

  PoseSteps operator*(double factor) const {
    return {factor * rotation_rad, factor * translation_m};
  }
};

/// Exp(delta) * pose, where delta is so many `steps` along each of its components: the camera
/// turns about its own centre and moves along its own axes.
Rigid3 Moved(const Rigid3& pose, const Vector6d& count, const PoseSteps& steps);

/// How many `steps` lead from `from` to `to`; the inverse of Moved.
Vector6d StepsBetween(const Rigid3& from, const Rigid3& to, const PoseSteps& steps);

/// Calls take(pose) for the 3^6 - 1 = 728 poses of which each component of delta is one step back,
/// the same, or one step on.
void ForEachNeighbour(const Rigid3& pose, const PoseSteps& steps,
                      const std::function<void(const Rigid3&)>& take);

/// F_C of Levinson and Thrun (2013): the share of those neighbours that are worse than the pose,
/// 0 to 1. Chance makes it about a half; 1: a peak as wide as the steps.
double ShareWorse(const PoseObjective& objective, const Rigid3& pose, const PoseSteps& steps);

/// In words, for SceneFit::why_not; empty where ShareWorse is at least `least`.
std::string WhyNoPeak(double share_worse, double least, const PoseSteps& steps);

/// In words, of a search that ended at its limits.
std::string WhyAtBorder(const PoseSteps& reach);

}  // namespace rgbdt
