#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/model/view_detection.h"

namespace rgbdt {

struct Errors {
  double worst = 1e9, rms = 1e9;  ///< [px]
  bool turned = false;            ///< half a turn from the truth
};

/// Of the corners that are seen; the order is the truth's or half a turn off it.
inline Errors Compare(const std::vector<Eigen::Vector2d>& corners,
                      const std::vector<Eigen::Vector2d>& truth) {
  Errors best;
  if (corners.size() != truth.size()) return best;
  for (const bool turned : {false, true}) {
    double worst = 0;
    double sum = 0;
    double seen = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Eigen::Vector2d& corner = corners[turned ? truth.size() - 1 - i : i];
      if (!IsSeen(corner)) continue;
      const double error = (corner - truth[i]).norm();
      worst = std::max(worst, error);
      sum += error * error;
      ++seen;
    }
    if (worst < best.worst) best = {worst, std::sqrt(sum / seen), turned};
  }
  return best;
}

}  // namespace rgbdt
