#pragma once

#include <optional>
#include <string>

#include "calib/files/import/lens_file.h"
#include "calib/model/cloud.h"
#include "services/import/ros_messages.h"

namespace rgbdt {

// Messages of ROS as the library's own structs. Each throws InputError, which begins with `where`.

/// As a PCD of the same fields would be read (calib/files/points/cloud_files.h), so a point that is
/// not finite or at 0 0 0 is a beam that returned nothing. Besides, by their drivers' names:
///  - reflectivity, where there is no intensity;
///  - channel or line (8 or 16 bit), where there is no ring;
///  - line and tag: a Livox. No rings, and only points that its tags call normal
///    (calib/model/livox.h) and that are not at 0 0 0;
///  - t, time, timestamp, offset_time: since the header's time, or since 1970; whole numbers are
///    [ns], others [s], where they are too large for that [ns].
/// `height` rows above 1 are an organised cloud's lines. sweep_utime is the header's time.
/// Big-endian clouds are refused.
Cloud ToCloud(const ros::PointCloud& cloud, const std::string& where);

/// A Livox's, by its fields: of a pattern that does not repeat, so those of a second are one cloud.
bool IsLivox(const ros::PointCloud& cloud);

/// The lens, as ParseLensFile reads the same camera_info from a file; nothing where K is zero: the
/// camera was never calibrated.
std::optional<FileLens> ToLens(const ros::CameraInfo& info, const LensWanted& wanted);

}  // namespace rgbdt
