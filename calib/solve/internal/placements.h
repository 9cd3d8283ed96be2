#pragma once

#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// How many different places of the board there are: poses within 10 mm (3 mm per metre beyond
/// 3.3 m) and 0.3 degrees of one another, or turned by half, are the board left where it was.
/// `factor` is by how much their variance is larger than that of as many different places.
struct Placements {
  int places = 0;
  double factor = 1;
};

/// Of views in which the board stood in the same place the beams meet its sides in the same
/// points, and its shape is the same: what that puts off does not average out. Of the variance of
/// one view the part rho = 0.25 is such (measured, 32 and 16 rings, four places of 4 and of 10
/// views), so that n views of each place have 1 + (n - 1) rho times the variance of n places (Kish
/// 1965, Survey Sampling, 5.4: the design effect of clusters; of unequal ones n is the sum of
/// squares over the sum). `lidar_from_target`: the board's pose in each view.
Placements PlacementsOf(const std::vector<Rigid3>& lidar_from_target);

}  // namespace rgbdt
