#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt {

/// A report for a terminal. The report must outlive it.
class Summary {
 public:
  explicit Summary(const Report& report) : report_(report) {}

  /// Whether every camera, and every LIDAR beside the reference, has a pose to use.
  bool converged() const;
  /// One line: how each camera's solve ended, and its projection uncertainty; of the paper's
  /// method the mean distance transform.
  std::string BriefReport() const;
  /// The cameras' verdicts; a table, units in the first column, cameras side by side; what has no
  /// room in it, in lines below. Why a view was rejected is left out where it is one of `told`.
  std::string FullReport(const std::vector<std::string>& told = {}) const;

 private:
  const Report& report_;
};

}  // namespace rgbdt
