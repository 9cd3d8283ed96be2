#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/range_errors.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt::study {

/// What was recorded by one camera and one LIDAR, and what detection makes of it.
struct Recorded {
  Rig rig;
  std::vector<Cloud> clouds;  ///< one a view
  std::vector<ViewDetection> views;
};

/// How far each ring's points on the boards lie behind the boards' planes, along their beams, as
/// measured and corrected by `errors`; a line for each view and ring.
/// @return the RMS of all points after over before; nothing where no board's points are known
/// @throws std::runtime_error where `path` cannot be written, as all here
std::optional<double> WriteRings(const Recorded& recorded, const RangeErrors& errors,
                                 const std::string& path);

/// What the joint solve leaves of the given lens and all views, in two files.
/// `views_path`: the board as each view's cloud alone has it against how its image alone has it:
/// delta about and along the target's axes with its sigma [mrad, mm].
/// `sides_path`: by view and side, how far the crossings of that side lie beyond where the board's
/// pose puts it, what all views share taken off: as an angle of the beam with its sigma by the
/// crossings' own noise [mrad]; how many crossings, their class (CrossingKind), range [m], the
/// side's tilt against the scan lines [deg] and the angle between beam and normal [deg].
void WriteResiduals(const Recorded& recorded, const std::string& views_path,
                    const std::string& sides_path);

}  // namespace rgbdt::study
