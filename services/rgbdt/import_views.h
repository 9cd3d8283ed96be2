#pragma once

#include <string>
#include <vector>

#include "services/import/import_bag.h"
#include "services/rgbdt/import_flags.h"

namespace rgbdt {

/// The board and the lenses that a person gives.
RigWishes RigWishesOf(const ImportFlags& flags);

/// The cameras whose lens is still to be found.
std::vector<std::string> WithoutLens(const Rig& rig);

/// The views that are to be: where the board stands still, or those asked for; says what was seen.
/// Throws InputError: the board is nowhere, or has other counts of squares.
std::vector<Moment> MomentsOf(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                              const ImportFlags& flags, std::vector<std::string>* left_over);

}  // namespace rgbdt
