#pragma once

#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// A whole sweep as the CLOUD messages that it travels in: so many lines a chunk that none is
/// large (a lost datagram loses a message), the last with `sweep_end`. An unorganised cloud is cut
/// into stretches of equal length, the last filled up with points that nothing is known of.
std::vector<CloudChunk> SplitSweep(const Cloud& sweep);

/// Throws InputError where two chunks of a sweep differ in beams per line or in which of a cloud's
/// vectors they fill.
void RequireJoinable(const Cloud& a, const Cloud& b);

/// Puts chunks back together, in the order of their lines; a chunk that came twice counts once.
/// Lines that never came become lines of NaN without known directions, so neighbours in the cloud
/// are neighbours in the sweep. Throws InputError where they are not joinable.
Cloud JoinChunks(const std::vector<CloudChunk>& chunks);

}  // namespace rgbdt
