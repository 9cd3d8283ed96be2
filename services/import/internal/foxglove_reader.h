#pragma once

// Foxglove's messages as those of ROS that say the same.

#include <string>
#include <vector>

#include "services/import/ros_messages.h"

namespace rgbdt::ros {

/// `type`: "foxglove.RawImage", ...CompressedImage or ...PointCloud.
Header FoxgloveHeader(const BagMessage& message, const std::string& type);
/// foxglove.RawImage
Image FoxgloveImage(const BagMessage& message);
/// foxglove.CompressedImage
CompressedImage FoxgloveCompressedImage(const BagMessage& message);
/// foxglove.CameraCalibration
CameraInfo FoxgloveCameraInfo(const BagMessage& message);
/// foxglove.PointCloud
PointCloud FoxglovePointCloud(const BagMessage& message);
/// foxglove.FrameTransforms
std::vector<Transform> FoxgloveTransforms(const BagMessage& message);

/// What every reader of a transform looks after: a slash before a frame's name goes, the rotation
/// is one. Throws InputError otherwise.
void CheckTransform(Transform* transform);

}  // namespace rgbdt::ros
