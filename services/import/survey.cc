#include "services/import/survey.h"

#include <algorithm>
#include <map>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/bags/printable.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostStamped = 2'000'000;
constexpr std::size_t kMostTransforms = 10'000;

BagData DataOf(const BagTopic& topic) {
  static const std::map<std::string, BagData> ros = {
      {"sensor_msgs/Image", BagData::kImage},
      {"sensor_msgs/CompressedImage", BagData::kCompressedImage},
      {"sensor_msgs/CameraInfo", BagData::kCameraInfo},
      {"sensor_msgs/PointCloud2", BagData::kCloud}};
  static const std::map<std::string, BagData> foxglove = {
      {"foxglove.RawImage", BagData::kImage},
      {"foxglove.CompressedImage", BagData::kCompressedImage},
      {"foxglove.CameraCalibration", BagData::kCameraInfo},
      {"foxglove.PointCloud", BagData::kCloud}};
  if (topic.encoding == BagEncoding::kOther) return BagData::kOther;
  const auto& types = topic.encoding == BagEncoding::kProtobuf ? foxglove : ros;
  const auto found = types.find(topic.type);
  return found == types.end() ? BagData::kOther : found->second;
}

bool IsStatic(const BagTopic& topic) {
  static const std::string kName = "tf_static";
  const std::string& name = topic.name;
  const bool of_transforms =
      topic.encoding == BagEncoding::kProtobuf
          ? topic.type == "foxglove.FrameTransforms"
          : topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
  return topic.encoding != BagEncoding::kOther && of_transforms && name.size() >= kName.size() &&
         name.compare(name.size() - kName.size(), kName.size(), kName) == 0;
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
        if (seen->what.empty()) seen->what = Describe(ros::DecodeImage(message, encoding));
        return Keep(message, seen);
      case BagData::kCompressedImage:
        if (seen->what.empty()) {
          const auto image = ros::DecodeCompressedImage(message, encoding);
          seen->what = Printable(image.format);
        }
        return Keep(message, seen);
      case BagData::kCloud:
        if (seen->what.empty()) seen->what = Describe(ros::DecodePointCloud(message, encoding));
        return Keep(message, seen);
      case BagData::kCameraInfo: {
        if (seen->info && seen->info->k[0] != 0) return;
        seen->info = ros::DecodeCameraInfo(message, encoding);
        return;
      }
      case BagData::kOther:
        if (IsStatic(seen->topic)) AddTransforms(ros::DecodeTransforms(message, encoding));
    }
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
