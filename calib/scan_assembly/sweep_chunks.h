#pragma once

#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// A whole sweep as the CLOUD messages that it travels in: so many lines a chunk that none is
/// large (a lost datagram loses a message), the last with `sweep_end`. An unorganised cloud is cut
/// into stretches of equal length, the last filled up with points that nothing is known of.
std::vector<CloudChunk> SplitSweep(const Cloud& sweep);

}  // namespace rgbdt
