#include "services/import/survey.h"

#include <algorithm>
#include <map>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/bags/printable.h"
#include "services/import/sensor_data.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostStamped = 2'000'000;
constexpr std::size_t kMostTransforms = 10'000;

bool EndsWith(const std::string& name, const std::string& end) {
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

BagData DataOf(const BagTopic& topic) {
  static const std::map<std::string, BagData> ros = {
      {"sensor_msgs/Image", BagData::kImage},
      {"sensor_msgs/CompressedImage", BagData::kCompressedImage},
      {"sensor_msgs/CameraInfo", BagData::kCameraInfo},
      {"sensor_msgs/PointCloud2", BagData::kCloud},
      {"livox_ros_driver/CustomMsg", BagData::kCloud},
      {"livox_ros_driver2/CustomMsg", BagData::kCloud}};
  static const std::map<std::string, BagData> foxglove = {
      {"foxglove.RawImage", BagData::kImage},
      {"foxglove.CompressedImage", BagData::kCompressedImage},
      {"foxglove.CameraCalibration", BagData::kCameraInfo},
      {"foxglove.PointCloud", BagData::kCloud}};
  if (topic.encoding == BagEncoding::kOther) return BagData::kOther;
  const auto& types = topic.encoding == BagEncoding::kProtobuf ? foxglove : ros;
  const auto found = types.find(topic.type);
  if (topic.encoding != BagEncoding::kProtobuf) {
    if (ros::IsPackets(topic.type)) return BagData::kPackets;
    if (topic.type == "std_msgs/String" && EndsWith(topic.name, "metadata")) {
      return BagData::kMetadata;
    }
  }
  return found == types.end() ? BagData::kOther : found->second;
}

bool IsStatic(const BagTopic& topic) {
  const bool of_transforms =
      topic.encoding == BagEncoding::kProtobuf
          ? topic.type == "foxglove.FrameTransforms"
          : topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
  return topic.encoding != BagEncoding::kOther && of_transforms &&
         EndsWith(topic.name, "tf_static");
}

std::string Describe(const ros::Image& image) {
  return Format("%ux%u ", image.width, image.height) + Printable(image.encoding);
}

std::string Describe(const ros::PointCloud& cloud) {
  std::string text = Format("%ux%u", cloud.width, cloud.height);
  constexpr std::size_t kMost = 12;
  for (std::size_t i = 0; i < std::min(kMost, cloud.fields.size()); ++i) {
    text += " " + Printable(cloud.fields[i].name);
  }
  return cloud.fields.size() > kMost ? text + " ..." : text;
}

class Surveyor {
 public:
  void Take(const BagTopic& topic, const BagMessage& message) {
    BagSurvey::Topic& seen = TopicOf(topic, message.topic);
    if (seen.messages++ == 0) seen.first_log = seen.last_log = message.log_utime;
    seen.first_log = std::min(seen.first_log, message.log_utime);
    seen.last_log = std::max(seen.last_log, message.log_utime);
    seen.bytes += message.size;
    if (stamped_ >= kMostStamped) {
      throw InputError("more than " + std::to_string(kMostStamped) +
                       " images and clouds in one bag; split it");
    }
    try {
      Look(message, &seen);
    } catch (const InputError& error) {
      ++seen.unreadable;
      seen.problem = error.what();
    }
  }

  BagSurvey Finish(const std::vector<BagTopic>& topics, std::vector<std::string> problems) {
    if (!topics.empty()) TopicOf(topics.back(), topics.size() - 1);
    for (std::size_t i = 0; i < topics.size(); ++i) TopicOf(topics[i], i).topic = topics[i];
    for (BagSurvey::Topic& topic : survey_.topics) {
      std::stable_sort(topic.stamped.begin(), topic.stamped.end(),
                       [](const Stamped& a, const Stamped& b) { return a.utime < b.utime; });
    }
    std::sort(survey_.topics.begin(), survey_.topics.end(),
              [](const auto& a, const auto& b) { return a.topic.name < b.topic.name; });
    survey_.problems = std::move(problems);
    return std::move(survey_);
  }

 private:
  BagSurvey::Topic& TopicOf(const BagTopic& topic, std::size_t index) {
    if (survey_.topics.size() <= index) survey_.topics.resize(index + 1);
    BagSurvey::Topic& seen = survey_.topics[index];
    if (seen.topic.name.empty()) {
      seen.topic = topic;
      seen.data = DataOf(topic);
    }
    return seen;
  }

  void Look(const BagMessage& message, BagSurvey::Topic* seen) {
    const BagEncoding encoding = seen->topic.encoding;
    switch (seen->data) {
      case BagData::kImage:
        if (seen->what.empty()) {
          const ros::Image image = ros::DecodeImage(message, encoding);
          seen->unit = FloatUnitOf(image);
          seen->what = Describe(image);
        }
        return Keep(message, seen);
      case BagData::kCompressedImage:
        if (seen->what.empty()) {
          const auto image = ros::DecodeCompressedImage(message, encoding);
          seen->what = Printable(image.format);
        }
        return Keep(message, seen);
      case BagData::kCloud:
        if (seen->what.empty()) {
          const ros::PointCloud cloud = ros::DecodeCloud(message, seen->topic);
          seen->what = Describe(cloud);
          seen->livox = IsLivox(cloud);
        }
        return Keep(message, seen);
      case BagData::kPackets:
        if (seen->what.empty()) LookAtPackets(ros::DecodePackets(message, seen->topic), seen);
        return;
      case BagData::kMetadata:
        if (seen->text.empty()) seen->text = ros::DecodeText(message, encoding);
        return;
      case BagData::kCameraInfo: {
        ros::CameraInfo info = ros::DecodeCameraInfo(message, encoding);
        if (!seen->info || seen->info->k[0] == 0) {
          seen->info = std::move(info);
        } else if (info.k[0] != 0) {
          seen->info_changes |= info.k != seen->info->k || info.d != seen->info->d;
        }
        return;
      }
      case BagData::kOther:
        if (IsStatic(seen->topic)) AddTransforms(ros::DecodeTransforms(message, encoding));
    }
  }

  // A driver publishes its inertial sensor's small packets alike.
  static void LookAtPackets(const ros::Packets& packets, BagSurvey::Topic* seen) {
    constexpr std::size_t kLeast = 256;
    if (packets.packets.empty()) return;
    const std::size_t size = packets.packets.front().size;
    seen->frame = packets.header.frame;
    seen->what = Format("packets of %zu bytes, %zu a message", size, packets.packets.size());
    if (size < kLeast) seen->data = BagData::kOther;
  }

  void Keep(const BagMessage& message, BagSurvey::Topic* seen) {
    const ros::Header header = ros::DecodeHeader(message, seen->topic);
    if (seen->stamped.empty()) seen->frame = header.frame;
    ++stamped_;
    seen->stamped.push_back({header.utime != 0 ? header.utime : message.log_utime, message.place});
  }

  void AddTransforms(const std::vector<ros::Transform>& transforms) {
    for (const ros::Transform& transform : transforms) {
      if (survey_.transforms.size() == kMostTransforms) return;
      survey_.transforms.push_back(transform);
    }
  }

  BagSurvey survey_;
  std::size_t stamped_ = 0;
};

}  // namespace

double BagSurvey::Topic::Rate() const {
  const double seconds = ToSeconds(last_log - first_log);
  return messages < 2 || seconds <= 0 ? 0 : static_cast<double>(messages - 1) / seconds;
}

const BagSurvey::Topic* BagSurvey::Find(const std::string& name) const {
  for (const Topic& topic : topics) {
    if (topic.topic.name == name) return &topic;
  }
  return nullptr;
}

BagSurvey::Topic* BagSurvey::Find(const std::string& name) {
  return const_cast<Topic*>(std::as_const(*this).Find(name));
}

BagSurvey SurveyBag(BagReader* bag, const std::function<void(double)>& progress) {
  Surveyor surveyor;
  BagMessage message;
  while (bag->Next(&message)) {
    surveyor.Take(bag->topics()[message.topic], message);
    if (progress) {
      progress(static_cast<double>(bag->position()) /
               static_cast<double>(std::max<std::int64_t>(1, bag->size())));
    }
  }
  return surveyor.Finish(bag->topics(), bag->problems());
}

}  // namespace rgbdt
