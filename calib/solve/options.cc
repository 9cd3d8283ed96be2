#include "calib/solve/options.h"

#include "calib/model/errors.h"

namespace rgbdt {

void CalibrateOptions::Check() const {
  RequireMethod(method);
  first_guess.Check();
  const auto at_least = [](int value, int least, const char* name) {
    if (value < least) {
      throw InputError(std::string("CalibrateOptions.") + name + " is " + std::to_string(value) +
                       "; expected " + std::to_string(least) + " or more");
    }
  };
  at_least(min_views, 1, "min_views");
  at_least(max_iterations, 1, "max_iterations");
  at_least(folds, 2, "folds");
}

std::string TooFewViews(std::size_t usable, const CalibrateOptions& options) {
  return std::to_string(usable) + " usable views, at least " + std::to_string(options.min_views) +
         " are needed";
}

}  // namespace rgbdt
