#pragma once

#include <map>
#include <string>

#include "calib/model/rigid3.h"
#include "tests/study/sampled_sessions.h"

namespace rgbdt::study {

/// The least that an unbiased estimate of one camera's pose can be off.
struct CameraBound {
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta (rigid3.h), camera axes
  double rotation_deg = 0, centre_mm = 0;  ///< root mean square to be expected
  double rotation_deg_median = 0, centre_mm_median = 0;
};

/// What is made use of.
enum class BoundData {
  kAll,
  kPlanes,  ///< not where scans leave the board: what is left to point-to-plane methods
};

/// The Gaussian bound of the noise model, by camera, over the views that are not held out. Shares
/// no code with calib/solve. Unknown are the cameras' and the boards' poses (6 each) and, with
/// their priors, each camera's lens, the pattern's print, the board's shape and its sides, a shift
/// for each class of crossing, one for each side and view, the board's thickness, and what ranges
/// are off by: all of them, each ring's, black squares', and by where beams meet. Data are the
/// cameras' inner corners (CornerCovariance); the ranges of beams on the board, its rim left out;
/// and where rows and columns of beams leave the board: the interval between the last beam on it
/// and the first beyond counts as a Gaussian of variance width^2/12. All crossings of one side
/// between the same two columns (rows) have the same place in that interval, which therefore counts
/// once for all of them; the beams' blur counts for each. A beam that is the last of its row and of
/// its column tells of the side only once. Counted so, a little is left untold: with sparse beams
/// an estimate may come out some 5 to 10% below.
std::map<std::string, CameraBound> BoundOf(const SampledSession& session,
                                           BoundData data = BoundData::kAll);

}  // namespace rgbdt::study
