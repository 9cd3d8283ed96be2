#include "calib/solve/options.h"

#include "calib/model/check.h"

namespace rgbdt {

void CalibrateOptions::Check() const {
  RequireMethod(method);
  first_guess.Check();
  const OptionCheck check("calibrate");
  check.AtLeast(min_views, 1, "min_views");
  check.AtLeast(max_iterations, 1, "max_iterations");
  check.AtLeast(folds, 2, "folds");
}

std::string TooFewViews(std::size_t usable, const CalibrateOptions& options) {
  return std::to_string(usable) + " usable views, at least " + std::to_string(options.min_views) +
         " are needed";
}

}  // namespace rgbdt
