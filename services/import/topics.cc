#include "services/import/topics.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "calib/files/import/camera_kind.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/model/unique_names.h"
#include "services/bags/printable.h"
#include "services/import/internal/topic_names.h"
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

TopicParts Split(const Topic& topic) {
  return SplitTopic(topic.topic.name, topic.data == BagData::kCompressedImage);
}

// By image_proc: its CameraInfo is of the images before.
bool IsRectified(const Topic& topic) {
  const std::string& name = topic.topic.name;
  return name.find("_rect") != std::string::npos || name.find("/rect") != std::string::npos;
}

// Why these are not taken for a camera's images; empty: they may be.
std::string WhyNoCamera(const Topic& topic) {
  const std::string name = ToLower(topic.topic.name);
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

// Images whose camera has its name by the space that they are in.
std::multimap<std::string, const Topic*> NamedBySpace(const BagSurvey& survey) {
  std::multimap<std::string, const Topic*> named;
  for (const Topic& topic : survey.topics) {
    if (!IsImages(topic) || !WhyNoCamera(topic).empty()) continue;
    const TopicParts parts = Split(topic);
    if (parts.own.empty()) named.emplace(parts.space, &topic);
  }
  return named;
}

// The camera, as a path; empty: that without a space. Where the images' name says whose they are
// that is one by itself, unless it is of the frame of images beside it that are named by the space.
std::string CameraOf(const std::multimap<std::string, const Topic*>& named_by_space,
                     const Topic& images) {
  const TopicParts parts = Split(images);
  if (parts.own.empty()) return parts.space;
  const auto [begin, end] = named_by_space.equal_range(parts.space);
  const bool of_space = std::any_of(begin, end, [&](const auto& entry) {
    const std::string& frame = entry.second->frame;
    return frame.empty() || images.frame.empty() || frame == images.frame;
  });
  return of_space ? parts.space : parts.space + "/" + parts.own;
}

const Topic* InfoOf(const BagSurvey& survey, const Topic& images) {
  const TopicParts parts = Split(images);
  const std::string space = parts.space + "/";
  for (const std::string& name :
       {space + parts.leaf + "/camera_info", space + parts.own + "/camera_info",
        space + parts.own + "_camera_info", space + "camera_info"}) {
    const Topic* info = survey.Find(name);
    if (info != nullptr && info->info) return info;
  }
  return nullptr;
}

// One CameraInfo beside the images of several cameras is that one's whose frame it has.
void DropOthersInfo(const std::vector<std::string>& paths,
                    std::vector<TopicChoice::Camera>* cameras) {
  std::map<const Topic*, std::set<std::string>> cameras_of;
  for (std::size_t i = 0; i < paths.size(); ++i) cameras_of[(*cameras)[i].info].insert(paths[i]);
  for (TopicChoice::Camera& camera : *cameras) {
    if (camera.info == nullptr || cameras_of[camera.info].size() == 1) continue;
    const std::string& frame = camera.info->info->header.frame;
    if (frame.empty() || frame != camera.images->frame) camera.info = nullptr;
  }
}

// Of each camera the topic that is taken.
std::vector<const Topic*> SeenCameras(const BagSurvey& survey, std::vector<std::string>* left_out) {
  const auto named_by_space = NamedBySpace(survey);
  std::map<std::string, const Topic*> best;
  for (const Topic& topic : survey.topics) {
    if (!IsImages(topic)) continue;
    const std::string why = WhyNoCamera(topic);
    if (!why.empty()) {
      left_out->push_back(topic.topic.name + ": " + why);
      continue;
    }
    const Topic*& of_camera = best[CameraOf(named_by_space, topic)];
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
  const std::string name = ToLower(topic.topic.name);
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

std::vector<TopicChoice::Camera> CamerasOf(
    const BagSurvey& survey, const std::vector<std::pair<std::string, const Topic*>>& taken) {
  if (static_cast<std::int64_t>(taken.size()) > kMaxCameras) {
    throw InputError("the bag has more than " + std::to_string(kMaxCameras) +
                     " cameras; say by --image which are to be taken");
  }
  const auto named_by_space = NamedBySpace(survey);
  UniqueNames names;
  std::vector<std::string> paths;
  for (const auto& [name, images] : taken) {
    if (!name.empty() && !names.Insert(name)) {
      throw InputError("two cameras are called \"" + name + "\"; expected a name for each");
    }
    const std::string path = CameraOf(named_by_space, *images);
    paths.push_back(path.empty() ? Split(*images).leaf : path);
  }
  const std::vector<std::string> apart = TellApart(paths);
  std::vector<TopicChoice::Camera> cameras;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const auto& [name, images] = taken[i];
    TopicChoice::Camera& camera = cameras.emplace_back();
    camera.name = name.empty() ? names.Make(ShortName(apart[i])) : name;
    camera.images = images;
    camera.info = IsRectified(*images) ? nullptr : InfoOf(survey, *images);
  }
  DropOthersInfo(paths, &cameras);
  return cameras;
}

// By the space that the clouds are in.
std::string SensorName(const Topic& clouds) {
  const TopicParts parts = Split(clouds);
  return ShortName(TellApart({parts.space.empty() ? parts.leaf : parts.space})[0]);
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
  UniqueNames names;
  for (const TopicChoice::Camera& camera : choice->cameras) names.Insert(camera.name);
  std::set<const Topic*> topics;
  for (TopicChoice::Lidar& lidar : lidars) {
    if (lidar.name.empty() && lidars.size() > 1) {
      lidar.name = names.Make(SensorName(*lidar.clouds));
    } else {
      if (lidar.name.empty()) lidar.name = "lidar";
      if (!names.Insert(lidar.name)) {
        throw InputError("two sensors are called \"" + lidar.name + "\"; expected a name for each");
      }
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
  std::vector<std::pair<std::string, const Topic*>> taken;  // name (or empty), images
  for (const auto& [name, topic] : wishes.images) {
    taken.emplace_back(name, &Wanted(survey, topic, IsImages, "--image"));
  }
  if (wishes.images.empty() && !wishes.clouds_alone) {
    for (const Topic* topic : SeenCameras(survey, &choice.left_out)) taken.emplace_back("", topic);
  }
  choice.cameras = CamerasOf(survey, taken);
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
