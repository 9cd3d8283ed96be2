#pragma once

#include <string>
#include <vector>

#include "calib/files/schema/calibration_use.h"
#include "services/messages/message.h"

namespace rgbdt {

/// Throws InputError where the message's calibration is another rig's than the one on the bus; with
/// Use::kAnyway the reason is returned, or nothing. `before`: the rig that was heard before it, or
/// null. A message has only the hash of its rig; where that was this one, what differs is known,
/// and whether it counts.
std::vector<std::string> RequireRigOf(const CalibrationMessage& message, const Rig& rig,
                                      const Rig* before, Use use);

}  // namespace rgbdt
