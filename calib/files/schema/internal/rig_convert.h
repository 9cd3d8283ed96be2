#pragma once

#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/rig.h"

namespace rgbdt::text {

/// A rig's message; one of sensors alone (SensorsOf) has no target.
proto::Rig FromRig(const Rig& rig);

/// The reverse, not yet checked as a whole (Rig::Check). Throws InputError naming the field.
Rig ToRig(const proto::Rig& message, const Place& place, LensNeed lenses);

}  // namespace rgbdt::text
