#pragma once

// What a file of a fused cloud says in its comments, as its points have no
// place for it.

#include <string>
#include <vector>

#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// One line each: frame and units for a person, then what ReadFusedComments takes.
std::vector<std::string> FusedComments(const RgbdtCloud& cloud);

/// Sets sweep, cameras, calibrations and pose from the comments that begin with "rgbdt"; the others
/// are anybody's. Throws InputError naming `where` and the comment.
void ReadFusedComments(const std::vector<std::string>& comments, const std::string& where,
                       RgbdtCloud* cloud);

}  // namespace rgbdt
