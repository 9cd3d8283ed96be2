#pragma once

// The rig file's devices, to and from calib/model.

#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/rig.h"

namespace rgbdt::text {

/// All throw InputError where a field is missing or out of its range.
CameraDevice ToDevice(const proto::CameraDevice& device, const Place& place);
HokuyoDevice ToDevice(const proto::Hokuyo& device, const Place& place);
VelodyneDevice ToDevice(const proto::Velodyne& device, const Place& place);
PacketLidarDevice ToDevice(const proto::PacketLidar& device, PacketLidarDevice::Make make,
                           const Place& place);
PcdFolderDevice ToDevice(const proto::PcdFolder& device, const Place& place);
DynamixelDevice ToDevice(const proto::Dynamixel& device, const Place& place);

void FromDevice(const CameraDevice& device, proto::CameraDevice* out);
void FromDevice(const DynamixelDevice& device, proto::Dynamixel* out);
void FromLidarDevice(const LidarSpec& lidar, proto::Lidar* out);

}  // namespace rgbdt::text
