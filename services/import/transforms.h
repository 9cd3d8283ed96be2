#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/import/ros_messages.h"

namespace rgbdt {

/// to_from_from by these transforms, one after the other: point_in_to = pose * point_in_from.
/// Nothing where no chain of them leads there. Of two between the same frames the later one counts.
std::optional<Rigid3> FindTransform(const std::vector<ros::Transform>& transforms,
                                    const std::string& to, const std::string& from);

}  // namespace rgbdt
