#pragma once

#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

/// Points of a sweep in the images of the synthetic rig's cameras, by what is true of them: whether
/// a ray from the surface that the beam's middle met to the camera's centre is blocked. Beams that
/// met two surfaces are left out: nobody can say where their points are.
struct VisibilityScore {
  long hidden = 0, hidden_coloured = 0, visible = 0, visible_coloured = 0;

  void Add(const VisibilityScore& other);
  double HiddenColoured() const;   ///< share of the hidden ones
  double VisibleColoured() const;  ///< share of the visible ones
};

struct VisibilityScores {
  VisibilityScore whole;  ///< a sweep judged as a whole
  VisibilityScore live;   ///< chunk by chunk, after a sweep that went before
};

/// Which beams of a spinning LIDAR make a line: all of one direction, or all of one moment where
/// lasers look past each other by some columns, as an Ouster's do.
enum class Columns { kAligned, kStaggered };

/// A sweep of the rig's LIDAR past the board in one place, through SweepFuser.
VisibilityScores ScoreVisibility(const simulate::Options& options,
                                 Columns columns = Columns::kAligned);

}  // namespace rgbdt::study
