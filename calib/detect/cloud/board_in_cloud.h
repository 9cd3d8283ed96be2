#pragma once

#include <string>
#include <vector>

#include "calib/detect/cloud/rectangle_fit.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

struct BoardInCloudOptions {
  double range_sigma_m = 0.01;  ///< noise of a range (the rig file's); up to 45 mm is tried, too
  double max_range_m = 12;      ///< boards farther away are not looked for
  int max_candidates = 4;       ///< the likeliest are kept
  /// A turned scanner's cloud, all of one laser: its rings are the beams' numbers, not lasers.
  bool one_laser = false;
  BeamEdgeOptions edge;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// As the rig file describes the LIDAR.
BoardInCloudOptions OptionsFor(const LidarSpec& lidar);

/// Boards, likeliest first, or the reason why there are none.
struct BoardsInCloud {
  std::vector<CloudEdges> candidates;
  std::string why;
};

/// Every rectangle of the target's size in a cloud, without a guess or a crop: dense or sparse,
/// organised or not. Planar pieces are found, the beams on each and where scans leave it, and the
/// target's rectangle is fitted to those crossings. Doors and table tops may look like a board:
/// what is kept is for the views together to choose from. A candidate's `boundary` runs along the
/// fitted rectangle's sides; its pose is known up to half a turn.
BoardsInCloud FindBoards(const Cloud& cloud, const Target& target,
                         const BoardInCloudOptions& options = {});

}  // namespace rgbdt
