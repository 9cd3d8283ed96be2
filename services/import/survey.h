#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "services/bags/bag_reader.h"
#include "services/import/image_data.h"
#include "services/import/ros_messages.h"

namespace rgbdt {

/// A message that was seen, by when its sensor measured.
struct Stamped {
  Utime utime = 0;  ///< of its header, or, where that is 0, of the log
  BagPlace place;
};

enum class BagData { kImage, kCompressedImage, kCameraInfo, kCloud, kPackets, kMetadata, kOther };

/// What a bag holds.
struct BagSurvey {
  struct Topic {
    BagTopic topic;
    BagData data = BagData::kOther;
    std::size_t messages = 0;
    std::uint64_t bytes = 0;
    Utime first_log = 0, last_log = 0;
    /// Images and clouds, sorted by time; of packets none: the sweeps that they hold are not known.
    std::vector<Stamped> stamped;
    std::string frame;                    ///< of the first message
    std::string what;                     ///< of the first: "640x480 mono16", "2048x64 x y z ring"
    std::optional<ros::CameraInfo> info;  ///< the first that is calibrated, or else the first
    bool info_changes = false;            ///< a later one has another lens
    FloatUnit unit = FloatUnit::kNone;    ///< of the first image, where it is 32FC1
    bool livox = false;                   ///< clouds of which those of a second are one (IsLivox)
    std::string text;                     ///< of a topic "metadata": what the LIDAR says of itself
    std::string problem;                  ///< the last message that could not be read, and why
    std::size_t unreadable = 0;           ///< how many

    /// [Hz], by the log; 0: unknown
    double Rate() const;
  };
  std::vector<Topic> topics;               ///< sorted by name
  std::vector<ros::Transform> transforms;  ///< those that stay
  std::vector<std::string> problems;       ///< of the file, a line each

  const Topic* Find(const std::string& name) const;
  Topic* Find(const std::string& name);
};

/// Reads the whole bag once, and keeps of it what is small. `progress` gets 0 to 1. Throws
/// InputError where the disk fails, and for more than two million images and clouds.
BagSurvey SurveyBag(BagReader* bag, const std::function<void(double)>& progress);

}  // namespace rgbdt
