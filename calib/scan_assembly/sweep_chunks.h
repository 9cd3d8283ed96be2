#pragma once

#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// A whole sweep as the CLOUD messages that it travels in: so many lines a chunk that none is
/// large (a lost datagram loses a message), the last with `sweep_end`. Its lines are numbered from
/// 0, whatever its `first_line`: nothing is missing. An unorganised cloud is cut into stretches of
/// equal length, the last filled up with points that nothing is known of.
std::vector<CloudChunk> SplitSweep(const Cloud& sweep);

/// Throws InputError where two chunks of a sweep differ in beams per line or in which of a cloud's
/// vectors they fill.
void RequireJoinable(const Cloud& a, const Cloud& b);

/// Puts chunks back together, in the order of their lines; a chunk that came twice counts once. The
/// sweep is its lines from 0 to the last that came or, where its end tells more, `sweep_lines`. Of
/// an organised sweep those that never came become lines of NaN without known directions, so
/// neighbours in the cloud are neighbours in the sweep. Throws InputError where chunks are not
/// joinable, or for more than 100 million points. An unorganised sweep has the first one's origin.
Cloud JoinChunks(const std::vector<CloudChunk>& chunks);

/// How many of those lines never came, of an unorganised sweep's stretches, too.
int MissingLines(const std::vector<CloudChunk>& chunks);

}  // namespace rgbdt
