#pragma once

#include <filesystem>

#include "calib/model/errors.h"
#include "services/bags/bag_reader.h"
#include "services/import/image_data.h"
#include "services/import/sensor_data.h"
#include "services/import/survey.h"

namespace rgbdt::fuzz {

/// As the library's own, whatever the message is. Throws InputError.
inline void Convert(const BagMessage& message, BagData kind, BagEncoding encoding) {
  switch (kind) {
    case BagData::kImage:
      ToImage(ros::DecodeImage(message, encoding), "image");
      return;
    case BagData::kCompressedImage:
      ToImage(ros::DecodeCompressedImage(message, encoding), "image");
      return;
    case BagData::kCloud:
      ToCloud(ros::DecodePointCloud(message, encoding), "cloud");
      return;
    case BagData::kCameraInfo: {
      LensWanted wanted;
      wanted.file = "/camera_info";
      wanted.camera = "rgb";
      ToLens(ros::DecodeCameraInfo(message, encoding), wanted);
      return;
    }
    case BagData::kMetadata:
      ros::DecodeText(message, encoding);
      return;
    case BagData::kPackets:
      for (const char* type :
           {"velodyne_msgs/VelodyneScan", "pandar_msgs/PandarScan", "nebula_msgs/NebulaPackets",
            "hesai_ros_driver/UdpFrame", "ouster_ros/PacketMsg", "rslidar_msg/RslidarPacket",
            "robosense_msgs/RobosenseScan"}) {
        try {
          ros::DecodePackets(message, {"/packets", type, encoding});
        } catch (const InputError&) {  // it may be another's
        }
      }
      ToCloud(ros::DecodeLivoxCloud(message, encoding), "cloud");
      return;
    case BagData::kOther:
      ros::DecodeTransforms(message, encoding);
  }
}

/// Surveys a bag, and reads a few of its images and clouds once more, as `rgbdt import` does.
/// Throws InputError.
inline void ReadBag(const std::filesystem::path& path) {
  constexpr std::size_t kMost = 8;
  const auto bag = OpenBag(path);
  const BagSurvey survey = SurveyBag(bag.get(), [](double) {});
  for (const BagSurvey::Topic& topic : survey.topics) {
    for (std::size_t i = 0; i < topic.stamped.size() && i < kMost; ++i) {
      try {
        Convert(bag->Read(topic.stamped[i].place), topic.data, topic.topic.encoding);
      } catch (const InputError&) {  // the others may be good
      }
    }
  }
}

}  // namespace rgbdt::fuzz
