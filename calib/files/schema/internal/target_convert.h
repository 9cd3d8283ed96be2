#pragma once

#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/rig.h"

namespace rgbdt::text {

/// The board of a rig file: a checkerboard, ChArUco, a grid of AprilTags, holes or a plain one.
/// Throws InputError with file, line and field.
Target ToTarget(const proto::Target& target, const Place& place);

void FromTarget(const Target& spec, proto::Target* out);

}  // namespace rgbdt::text
