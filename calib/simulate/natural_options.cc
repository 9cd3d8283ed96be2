#include "calib/simulate/natural_options.h"

#include "calib/simulate/internal/option_checks.h"

namespace rgbdt::simulate {

void NaturalOptions::Check() const {
  kCheck.Between(step_m, 0, 5, "natural.step_m");
  kCheck.Between(turn_rad, 0, 30 * kDegree, "natural.turn_rad");
  kCheck.Between(people, 0, 20, "natural.people");
  kCheck.Between(leaves, 0, 10, "natural.leaves");
}

}  // namespace rgbdt::simulate
