#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/methods/natural/by_scene.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// How a calibration is refined without a target: "natural" is this project's own (natural/), the
/// others are published ones to compare with: "mi", "nmi" (mutual_information/), "gom"
/// (gradient_orientation/), "edge-grid" (edge_grid/).
inline const std::vector<std::string> kRefineMethodNames = {"natural", "mi", "nmi", "gom",
                                                            "edge-grid"};

struct RefineOptions {
  std::string method = kRefineMethodNames[0];
  NaturalOptions natural;  ///< the sigma of the start counts for all methods that know one
  /// Join the start's covariance with what the scene says, in place of natural's sigmas: the start
  /// was made from other data.
  bool join_start = false;
  std::size_t most_sweeps = 40;  ///< to solve with, and as many to judge by, spread evenly

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Refines the poses of `start` by what stands about: by the views that are not held out, judged by
/// those that are, or by the last one where none is. A camera that `start` lacks begins at the
/// rig's hand-measured guess. A result that fits the sweeps that were left out worse than the start
/// is not taken: the pose is the start's, and the status says so. One that did not converge has the
/// start's pose, too, and says why. Each camera that was solved has `scene` in its report; one
/// without a start, or without a view to solve with, has no pose and a status that says so. Throws
/// InputError for an unknown method, and for a start that is to be joined and has no covariance.
Report Refine(const Rig& rig, const std::vector<View>& views, const Calibration& start,
              const RefineOptions& options = {});

}  // namespace rgbdt
