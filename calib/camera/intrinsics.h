#pragma once

#include "calib/model/intrinsics.h"

namespace rgbdt {

struct IntrinsicsOptions {
  int min_views = 3;              ///< that can be used, for a result that is called converged
  double max_corner_sigmas = 6;   ///< a corner farther off than this is left out
  double max_left_out = 0.2;      ///< part of a view's corners beyond which the view is rejected
  double max_view_ratio = 4;      ///< a view's RMS over the median of the views', likewise
  double max_focal_sigma = 0.01;  ///< sigma of fx or fy over its value; more: not converged
  double max_rms_px = 3;          ///< of the result; more: the lens model does not fit
  int max_iterations = 150;       ///< of Levenberg-Marquardt, each time
  int grid_columns = 8, grid_rows = 6;  ///< of the coverage

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Finds a camera's lens from views of the checkerboard (Zhang 2000; the fisheye after Kannala and
/// Brandt 2006): a first guess from the views' homographies, then bundle adjustment of the lens and
/// of every view's pose with a robust loss, wrong corners and views left out with a reason each,
/// and a last solve by least squares. No first guess is needed, each view may be half a turn off.
/// Views that do not determine the lens (too few, none tilted) give converged = false and a status
/// that says so. The same input gives the same bits. Throws InputError for corners that are not
/// the target's.
IntrinsicsResult CalibrateIntrinsics(const IntrinsicsInput& input,
                                     const IntrinsicsOptions& options = {});

}  // namespace rgbdt
