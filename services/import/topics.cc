#include "services/import/topics.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "calib/files/import/camera_kind.h"
#include "calib/model/errors.h"
#include "services/bags/printable.h"
#include "services/messages/limits.h"

namespace rgbdt {
namespace {

using Topic = BagSurvey::Topic;

bool IsImages(const Topic& topic) {
  return topic.data == BagData::kImage || topic.data == BagData::kCompressedImage;
}

bool IsCloud(const Topic& topic) {
  return topic.data == BagData::kCloud || topic.data == BagData::kPackets;
}

bool HasMessages(const Topic& topic) {
  return topic.data == BagData::kPackets ? !topic.what.empty() : !topic.stamped.empty();
}

// "/cam/rgb/image_raw/compressed": the camera "/cam/rgb", and its images "image_raw".
struct Parts {
  std::string camera, images;
};

Parts Split(const Topic& topic) {
  std::string name = topic.topic.name;
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    const std::string end = transport;
    if (topic.data == BagData::kCompressedImage && name.size() > end.size() &&
        name.compare(name.size() - end.size(), end.size(), end) == 0) {
      name.erase(name.size() - end.size());
      break;
    }
  }
  const std::size_t slash = name.rfind('/');
  if (slash == std::string::npos) return {"", name};
  return {name.substr(0, slash), name.substr(slash + 1)};
}

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// By image_proc: its CameraInfo is of the images before.
bool IsRectified(const Topic& topic) {
  const std::string& name = topic.topic.name;
  return name.find("_rect") != std::string::npos || name.find("/rect") != std::string::npos;
}

// Why these are not taken for a camera's images; empty: they may be.
std::string WhyNoCamera(const Topic& topic) {
  const std::string name = Lower(topic.topic.name);
  const auto says = [&](const char* word) { return name.find(word) != std::string::npos; };
  if (topic.stamped.empty()) {
    return topic.problem.empty() ? "no messages" : "cannot be read: " + topic.problem;
  }
  if (says("depth") || says("disparity")) return "depth, no picture";
  if (topic.what.find("32FC1") != std::string::npos && topic.unit != FloatUnit::kKelvin) {
    const bool celsius = topic.unit == FloatUnit::kMaybeCelsius;
    if (!celsius) return "numbers of floating point (32FC1) that are no temperatures";
    if (!SaysThermal(name, true)) {
      return "numbers of floating point (32FC1), degrees Celsius or metres of depth; if they are "
             "temperatures, say --image thermal=" +
             topic.topic.name;
    }
  }
  if (IsRectified(topic)) return "rectified: another lens; --image takes it, with --lens";
  for (const char* word : {"mask", "label", "segment", "debug", "overlay"}) {
    if (says(word)) return std::string("named \"") + word + "\"; --image takes it";
  }
  return "";
}

// The smaller, the less was done to the pixels.
int Rank(const Topic& topic) {
  static const std::vector<std::string> order = {"image_raw", "image_color", "image", "image_mono"};
  const auto found = std::find(order.begin(), order.end(), Split(topic).images);
  return static_cast<int>(found - order.begin()) +
         (topic.data == BagData::kCompressedImage ? 100 : 0);
}

// 1 to 32 of a-z, 0-9 and _, as the rig file has it.
std::string SensorName(const Topic& topic, const std::set<std::string>& taken) {
  const Parts parts = Split(topic);
  const std::string whole = parts.camera.empty() ? parts.images : parts.camera;
  std::string name;
  for (const char c : whole.substr(whole.rfind('/') + 1)) {
    const auto u = static_cast<unsigned char>(c);
    name += std::isalnum(u) != 0 ? static_cast<char>(std::tolower(u)) : '_';
  }
  name = name.substr(0, 28);
  if (name.empty()) name = "sensor";
  std::string free = name;
  for (int i = 2; taken.count(free) != 0; ++i) free = name + "_" + std::to_string(i);
  return free;
}

std::string NamesOf(const BagSurvey& survey, bool (*is)(const Topic&)) {
  std::string names;
  for (const Topic& topic : survey.topics) {
    if (is(topic)) names += (names.empty() ? "" : ", ") + topic.topic.name;
  }
  return names.empty() ? "none" : names;
}

const Topic& Wanted(const BagSurvey& survey, const std::string& name, bool (*is)(const Topic&),
                    const std::string& option) {
  const Topic* topic = survey.Find(name);
  if (topic == nullptr || !is(*topic)) {
    const std::string why = topic == nullptr
                                ? "the bag has no such topic"
                                : "is of " + topic->topic.type + ", which is not read so";
    throw InputError(option + " " + name + ": " + why + "; there are: " + NamesOf(survey, is));
  }
  if (!HasMessages(*topic)) {
    throw InputError(option + " " + name + ": none of its messages can be read" +
                     (topic->problem.empty() ? "" : ": " + topic->problem));
  }
  return *topic;
}

const Topic* InfoOf(const BagSurvey& survey, const Topic& images) {
  const Topic* info = survey.Find(Split(images).camera + "/camera_info");
  return info != nullptr && info->info ? info : nullptr;
}

// Of each camera the topic that is taken.
std::vector<const Topic*> SeenCameras(const BagSurvey& survey, std::vector<std::string>* left_out) {
  std::map<std::string, const Topic*> best;
  for (const Topic& topic : survey.topics) {
    if (!IsImages(topic)) continue;
    const std::string why = WhyNoCamera(topic);
    if (!why.empty()) {
      left_out->push_back(topic.topic.name + ": " + why);
      continue;
    }
    const Topic*& of_camera = best[Split(topic).camera];
    const Topic* worse = &topic;
    if (of_camera == nullptr || Rank(topic) < Rank(*of_camera)) std::swap(of_camera, worse);
    if (worse != nullptr) {
      left_out->push_back(worse->topic.name + ": " + of_camera->topic.name + " is taken instead");
    }
  }
  std::vector<const Topic*> topics;
  topics.reserve(best.size());
  for (const auto& [camera, topic] : best) topics.push_back(topic);
  return topics;
}

// What cameras have coloured comes of no LIDAR.
bool IsColoured(const Topic& topic) {
  std::istringstream fields(topic.what);
  const std::set<std::string> names{std::istream_iterator<std::string>(fields), {}};
  return names.count("rgb") + names.count("rgba") + names.count("red") != 0;
}

// What programs make of LIDARs' clouds, and what depth cameras tell.
std::string MadeWord(const Topic& topic) {
  const std::string name = Lower(topic.topic.name);
  for (const char* word :
       {"depth", "disparity", "concat", "merge", "fused", "filter", "crop", "downsample", "voxel",
        "ground", "obstacle", "segment", "cluster", "map", "debug"}) {
    if (name.find(word) != std::string::npos) return word;
  }
  return "";
}

// The frame, which each LIDAR has of its own. An Ouster's packets have none.
bool OfOneFrame(const Topic& a, const Topic& b) {
  const bool unknown = a.frame.empty() && b.frame.empty();
  if (unknown && a.data == BagData::kPackets && b.data == BagData::kPackets) return false;
  return a.frame == b.frame;
}

// Of several topics one a LIDAR.
void RequireLidars(const BagSurvey& survey, const std::vector<const Topic*>& found,
                   bool one_lidar) {
  if (found.empty()) {
    throw InputError(
        "the bag holds no clouds; expected a topic of sensor_msgs/PointCloud2, "
        "foxglove.PointCloud, a Livox's CustomMsg, or of packets");
  }
  const std::string which = "say which by --cloud: " + NamesOf(survey, IsCloud);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!OfOneFrame(*found[i], *found[j])) continue;
      throw InputError("several topics hold clouds of one frame, \"" + Printable(found[i]->frame) +
                       "\": they may be one LIDAR's; " + which);
    }
  }
  if (one_lidar && found.size() > 1) {
    throw InputError("the bag has several LIDARs, and a log carries the clouds of one (CLOUD); " +
                     which);
  }
}

std::vector<const Topic*> SeenLidars(const BagSurvey& survey, bool one_lidar,
                                     std::vector<std::string>* left_out) {
  std::vector<const Topic*> measured, made, coloured, packets;
  for (const Topic& topic : survey.topics) {
    if (!IsCloud(topic) || !HasMessages(topic)) continue;
    const bool of_packets = topic.data == BagData::kPackets;
    (of_packets                 ? packets
     : IsColoured(topic)        ? coloured
     : !MadeWord(topic).empty() ? made
                                : measured)
        .push_back(&topic);
  }
  std::vector<const Topic*> found;
  for (auto* of_kind : {&measured, &made, &packets, &coloured}) {
    if (found.empty()) found.swap(*of_kind);
  }
  RequireLidars(survey, found, one_lidar);
  for (const Topic* topic : made) {
    left_out->push_back(topic->topic.name + ": named \"" + MadeWord(*topic) +
                        "\"; --cloud takes it");
  }
  for (const Topic* topic : packets) {
    left_out->push_back(topic->topic.name + ": packets, and " + found[0]->topic.name +
                        " has clouds; --cloud takes it");
  }
  for (const Topic* topic : coloured) {
    left_out->push_back(topic->topic.name + ": coloured by cameras; --cloud takes it");
  }
  return found;
}

void ChooseLidars(const BagSurvey& survey, const TopicWishes& wishes, TopicChoice* choice) {
  std::vector<TopicChoice::Lidar> lidars;
  for (const auto& [name, topic] : wishes.clouds) {
    lidars.push_back({name, &Wanted(survey, topic, IsCloud, "--cloud")});
  }
  if (lidars.empty()) {
    for (const Topic* topic : SeenLidars(survey, wishes.one_lidar, &choice->left_out)) {
      lidars.push_back({"", topic});
    }
  }
  // A camera may look the same way.
  std::set<std::string> names;
  for (const TopicChoice::Camera& camera : choice->cameras) names.insert(camera.name);
  std::set<const Topic*> topics;
  for (TopicChoice::Lidar& lidar : lidars) {
    if (lidar.name.empty()) {
      lidar.name = lidars.size() == 1 ? "lidar" : SensorName(*lidar.clouds, names);
    }
    if (!names.insert(lidar.name).second) {
      throw InputError("two sensors are called \"" + lidar.name + "\"; expected a name for each");
    }
    if (!topics.insert(lidar.clouds).second) {
      throw InputError("--cloud " + lidar.clouds->topic.name +
                       " is given for two LIDARs; expected one topic for each");
    }
  }
  choice->lidar = lidars[0];
  choice->further_lidars.assign(lidars.begin() + 1, lidars.end());
}

}  // namespace

const BagSurvey::Topic* MetadataOf(const BagSurvey& survey, const BagSurvey::Topic& packets) {
  const std::string& name = packets.topic.name;
  const std::string space = name.substr(0, name.rfind('/') + 1);
  const Topic* only = nullptr;
  int count = 0;
  for (const Topic& topic : survey.topics) {
    if (topic.data != BagData::kMetadata || topic.text.empty()) continue;
    if (topic.topic.name == space + "metadata") return &topic;
    only = &topic;
    ++count;
  }
  return count == 1 ? only : nullptr;
}

TopicChoice ChooseTopics(const BagSurvey& survey, const TopicWishes& wishes) {
  TopicChoice choice;
  std::set<std::string> names;
  const auto add = [&](const std::string& wish, const Topic& topic) {
    if (static_cast<std::int64_t>(choice.cameras.size()) >= kMaxCameras) {
      throw InputError("the bag has more than " + std::to_string(kMaxCameras) +
                       " cameras; say by --image which are to be taken");
    }
    TopicChoice::Camera camera;
    camera.name = wish.empty() ? SensorName(topic, names) : wish;
    if (!names.insert(camera.name).second) {
      throw InputError("two cameras are called \"" + camera.name + "\"; expected a name for each");
    }
    camera.images = &topic;
    camera.info = IsRectified(topic) ? nullptr : InfoOf(survey, topic);
    choice.cameras.push_back(camera);
  };
  for (const auto& [name, topic] : wishes.images) {
    add(name, Wanted(survey, topic, IsImages, "--image"));
  }
  if (wishes.images.empty() && !wishes.clouds_alone) {
    for (const Topic* topic : SeenCameras(survey, &choice.left_out)) add("", *topic);
  }
  if (choice.cameras.empty() && !wishes.clouds_alone) {
    std::string why;
    for (const std::string& line : choice.left_out) why += "; " + line;
    throw InputError(
        "the bag holds no camera's images; topics of images: " + NamesOf(survey, IsImages) + why);
  }
  ChooseLidars(survey, wishes, &choice);
  return choice;
}

}  // namespace rgbdt
