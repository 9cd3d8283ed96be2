#pragma once

#include <string>

#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// Bytes of one point in a cloud frame, see protocol.ts.
inline constexpr std::size_t kPointBytes = 32;

/// A fused cloud as a CloudFrame, `part` its number in the sweep. Its points come in an order that
/// scatters them evenly: any first part of the records is an even sample. Deterministic.
/// `view`: of a session, whose cloud it is; empty: the newest sweep.
std::string CloudFrame(const RgbdtCloud& cloud, int part, const std::string& view = "");

}  // namespace rgbdt
