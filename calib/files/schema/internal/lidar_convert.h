#pragma once

// LIDARs beside the reference, to and from their messages.

#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/calibration.h"

namespace rgbdt::text {

/// Without a covariance where it is not finite.
void FromLidarCalibration(const LidarCalibration& lidar, proto::LidarCalibration* out);
/// Throws InputError where it has no name, or numbers are not what they should be.
LidarCalibration ToLidarCalibration(const proto::LidarCalibration& lidar, const Place& place);

void FromLidarReport(const LidarReport& lidar, proto::LidarReport* out);
/// Throws InputError likewise.
LidarReport ToLidarReport(const proto::LidarReport& lidar, const Place& place);

}  // namespace rgbdt::text
