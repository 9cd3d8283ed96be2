#pragma once

#include <string>

#include "calib/model/method.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {

struct CalibrateOptions {
  std::string method = kAutoMethod;
  FirstGuessOptions first_guess;  ///< "auto", "plane"; a range offset of 0: the rig's
  bool joint = true;              ///< "auto": all cameras together; false: each by itself
  /// "auto", "plane": folds, halves, closure and the next view are worked out, too: for a report.
  bool diagnostics = true;
  int folds = 5;              ///< "auto", "plane": parts of the views, each left out once
  bool smooth_field = false;  ///< "paper": the distance field goes on beyond the image's borders
  int min_views = 3;          ///< usable views for a result that may be called converged
  int max_iterations = 1000;  ///< of Levenberg-Marquardt
  bool wide_start = true;     ///< "paper": solve a second time from a start turned away
  double wide_roll_rad = 0.52359877559829887;  ///< 30 deg about the LIDAR's x (paper, Figure 6)
  double wide_yaw_rad = 0.69813170079773179;   ///< 40 deg about the LIDAR's z

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The detail of the status of a camera without enough views.
std::string TooFewViews(std::size_t usable, const CalibrateOptions& options);

}  // namespace rgbdt
