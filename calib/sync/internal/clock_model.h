#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/model/statistics.h"

namespace rgbdt::sync {

/// An offset over time, as measured.
struct OffsetsOverTime {
  Eigen::VectorXd seconds;     ///< rising
  Eigen::VectorXd values;      ///< [s]
  Eigen::MatrixXd covariance;  ///< [s^2]
};

/// What the offsets look like, beyond chance.
struct ClockModel {
  double mean_s = 0;              ///< over all times
  double spread_s = 0;            ///< RMS of the values about it, beyond their noise
  std::optional<Estimate> drift;  ///< [s/s]
  struct Jump {
    double seconds = 0;
    Estimate by_s;
  };
  std::optional<Jump> jump;
  bool wanders = false;  ///< it changes, and is neither
};

/// Generalised least squares: a constant, a line, a step. What is more is taken only where chance
/// makes chi-square fall as far once in some 10,000 times.
ClockModel FitClock(const OffsetsOverTime& offsets);

}  // namespace rgbdt::sync
