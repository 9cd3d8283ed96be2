#include "calib/methods/scene/pose_search.h"

#include <cmath>
#include <cstdio>

namespace rgbdt {
namespace {

std::string Degrees(const PoseSteps& steps) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2g deg or %.3g mm", steps.rotation_rad * 180 / M_PI,
                1000 * steps.translation_m);
  return text;
}

Vector6d Lengths(const PoseSteps& steps) {
  Vector6d lengths;
  lengths << Eigen::Vector3d::Constant(steps.rotation_rad),
      Eigen::Vector3d::Constant(steps.translation_m);
  return lengths;
}

}  // namespace

Rigid3 Moved(const Rigid3& pose, const Vector6d& count, const PoseSteps& steps) {
  return Exp(count.cwiseProduct(Lengths(steps))) * pose;
}

Vector6d StepsBetween(const Rigid3& from, const Rigid3& to, const PoseSteps& steps) {
  return Log(to * from.Inverse()).cwiseQuotient(Lengths(steps));
}

void ForEachNeighbour(const Rigid3& pose, const PoseSteps& steps,
                      const std::function<void(const Rigid3&)>& take) {
  constexpr int kCombinations = 729;
  for (int number = 0; number < kCombinations; ++number) {
    if (number == kCombinations / 2) continue;  // the pose itself
    Vector6d count;
    int rest = number;
    for (int k = 0; k < 6; ++k, rest /= 3) count[k] = rest % 3 - 1;
    take(Moved(pose, count, steps));
  }
}

double ShareWorse(const PoseObjective& objective, const Rigid3& pose, const PoseSteps& steps) {
  const double here = objective(pose);
  int worse = 0;
  int all = 0;
  ForEachNeighbour(pose, steps, [&](const Rigid3& neighbour) {
    worse += objective(neighbour) < here ? 1 : 0;
    ++all;
  });
  return static_cast<double>(worse) / all;
}

std::string WhyNoPeak(double share_worse, double least, const PoseSteps& steps) {
  if (share_worse >= least) return "";
  char text[256];
  std::snprintf(text, sizeof text,
                "only %.0f%% of the poses %s away fit worse (expected %.0f%% or more): the scene "
                "does not tell the pose; take more views, of a scene with more contrast and edges",
                100 * share_worse, Degrees(steps).c_str(), 100 * least);
  return text;
}

std::string WhyAtBorder(const PoseSteps& reach) {
  return "the best pose found is as far from the start as the search goes (" + Degrees(reach) +
         "): start from a better guess, or take views of a scene with more contrast";
}

}  // namespace rgbdt
