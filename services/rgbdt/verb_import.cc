#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/check_writable.h"
#include "calib/files/import/board_text.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/import/import_bag.h"
#include "services/rgbdt/folder_flags.h"
#include "services/rgbdt/import_flags.h"
#include "services/rgbdt/import_to_log.h"
#include "services/rgbdt/import_views.h"
#include "services/rgbdt/packet_import.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

// A small bag is read at once.
std::function<void(double)> ReadingProgress(const BagReader& bag) {
  constexpr std::int64_t kLarge = 300'000'000;
  return bag.size() < kLarge ? nullptr : Tenths("reading");
}

void PrintTopics(const BagReader& bag, const BagSurvey& survey) {
  std::printf("%s, %.1f MB:\n", bag.format().c_str(), static_cast<double>(bag.size()) / 1e6);
  for (const BagSurvey::Topic& topic : survey.topics) {
    std::string line = topic.topic.name + "  " + topic.topic.type + "  " +
                       std::to_string(topic.messages) + " messages";
    if (topic.Rate() > 0) line += Format(", %.3g Hz", topic.Rate());
    line += Format(", %.1f MB", static_cast<double>(topic.bytes) / 1e6);
    if (!topic.what.empty()) line += "  " + topic.what;
    if (topic.topic.encoding == BagEncoding::kOther)
      line += "  (neither of ROS nor Protobuf: not read)";
    std::printf("  %s\n", line.c_str());
    if (topic.unreadable > 0) {
      std::printf("    %zu of them unreadable, the last: it %s\n", topic.unreadable,
                  topic.problem.c_str());
    }
  }
  for (const std::string& problem : survey.problems) std::printf("problem: %s\n", problem.c_str());
}

// "NAME=TOPIC", or a topic alone.
std::vector<std::pair<std::string, std::string>> NamedTopics(
    const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, std::string>> topics;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      topics.emplace_back("", text);
    } else {
      topics.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  }
  return topics;
}

void CheckFlags(const ImportFlags& flags) {
  if (flags.pinhole && flags.fisheye) {
    throw InputError("--pinhole and --fisheye are both given; a lens is one of the two");
  }
  if (flags.every_s > 0 && !flags.at.empty()) {
    throw UsageError("--every and --at are both given; expected one of them, or neither");
  }
  if (flags.out.empty() != flags.board.empty()) {
    throw UsageError("--board and --out go together; with neither the bag is only listed");
  }
  if (!flags.log.empty() && !flags.out.empty()) {
    throw UsageError("--log and --out are both given; a bag becomes a log or a session");
  }
  const bool of_views = flags.every_s > 0 || !flags.at.empty() || flags.pinhole || flags.fisheye ||
                        !flags.lenses.empty();
  if (!flags.log.empty() && of_views) {
    throw UsageError(
        "--log takes all clouds and images, and the lenses of --session; expected no "
        "--every, --at, --lens, --pinhole or --fisheye");
  }
  if (!flags.log.empty() && flags.clouds.size() > 1) {
    throw UsageError("--log: a log carries the clouds of one LIDAR (CLOUD); expected one --cloud");
  }
  if (!flags.log.empty() && flags.session.empty() && !flags.images.empty()) {
    throw UsageError("--image: a log of images needs --session, their calibrated rig");
  }
  if (flags.log.empty() && !flags.session.empty()) {
    throw UsageError("--session goes with --log: the calibrated rig that the log is of");
  }
  if (flags.views < 1 || flags.views > 9999) {
    throw UsageError("--views is " + std::to_string(flags.views) + "; expected 1 to 9999");
  }
}

// A recording holds no images; those of a session are in folders.
int RunPackets(const ImportFlags& flags, const PacketImport* packets) {
  const bool of_bags = !flags.log.empty() || !flags.session.empty() || !flags.clouds.empty() ||
                       !flags.images.empty() || !flags.at.empty() || flags.every_s > 0;
  if (of_bags) {
    throw UsageError(flags.bag +
                     ": is a recording of packets, without images or topics; expected --images "
                     "DIR, --lens, --board and --out for a session, or --out alone for PCD files");
  }
  const bool of_session = !flags.board.empty() || !flags.lenses.empty() || flags.pinhole ||
                          flags.fisheye || flags.in_order;
  if (flags.image_folders.empty() && of_session) {
    throw UsageError(flags.bag +
                     ": is a recording of packets; a session of it needs the cameras' "
                     "folders, too: --images DIR");
  }
  if (packets == nullptr) {
    throw InputError(flags.bag + ": is a recording of packets; this build is without drivers");
  }
  if (flags.metadata.size() > 1) {
    throw UsageError("--metadata is given twice; a recording is read for one LIDAR");
  }
  const PacketsToImport what{flags.bag, flags.metadata.empty() ? "" : flags.metadata[0], flags.out,
                             flags.port};
  if (flags.image_folders.empty()) return packets->recording(what);
  if (flags.out.empty() || flags.board.empty()) {
    throw UsageError("--images is given without --board and --out; a session needs all three");
  }
  RequireRoomForSession(flags.out);
  const PairOptions pairing{flags.in_order, flags.max_apart_s};
  return packets->as_session(what, FoldersOf({flags.image_folders,
                                              {},
                                              flags.lenses,
                                              flags.board,
                                              flags.out,
                                              flags.pinhole,
                                              flags.fisheye,
                                              pairing}));
}

bool IsPacketFile(const std::string& path) {
  const std::string end = std::filesystem::path(path).extension().string();
  return end == ".pcap" || end == ".pcapng";
}

bool HasPackets(const TopicChoice::Lidar& lidar) { return lidar.clouds->data == BagData::kPackets; }

// Of each LIDAR with packets its --metadata; one without a name is the only one's.
std::map<std::string, std::string> MetadataFiles(const ImportFlags& flags,
                                                 const std::vector<TopicChoice::Lidar>& lidars) {
  std::vector<std::string> names;
  for (const TopicChoice::Lidar& lidar : lidars) {
    if (HasPackets(lidar)) names.push_back(lidar.name);
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  std::map<std::string, std::string> files;
  for (const std::string& text : flags.metadata) {
    if (names.empty()) {
      throw UsageError("--metadata is of packets; " + lidars[0].clouds->topic.name +
                       " holds clouds");
    }
    auto [name, file] = SplitName(text);
    if (name.empty() && names.size() == 1) name = names[0];
    if (std::count(names.begin(), names.end(), name) == 1 && files.emplace(name, file).second) {
      continue;
    }
    throw UsageError("--metadata " + text +
                     ": expected NAME=FILE, once for a LIDAR with packets: " + list);
  }
  return files;
}

// Messages, or packets, of which then the sweeps are known; the reference's first.
std::vector<CloudReader> CloudsOf(const ImportFlags& flags, const PacketImport* packets,
                                  const TopicChoice& choice, BagReader* bag, BagSurvey* survey) {
  std::vector<TopicChoice::Lidar> lidars = choice.further_lidars;
  lidars.insert(lidars.begin(), choice.lidar);
  std::map<std::string, std::string> metadata = MetadataFiles(flags, lidars);
  std::vector<CloudReader> readers;
  for (const TopicChoice::Lidar& lidar : lidars) {
    if (!HasPackets(lidar)) {
      readers.push_back(CloudMessages(bag, *lidar.clouds));
      continue;
    }
    const std::string& topic = lidar.clouds->topic.name;
    if (packets == nullptr) {
      throw InputError(topic + ": holds a LIDAR's packets; this build is without drivers");
    }
    readers.push_back(
        packets->in_bag({flags.bag, metadata[lidar.name], survey, survey->Find(topic)}));
  }
  return readers;
}

// A log may be an hour's drive, or the bag itself.
void RequireNew(const std::filesystem::path& log) {
  if (std::filesystem::exists(log)) {
    throw InputError(log.string() + " is there already; remove it or name another --log");
  }
  CheckWritable(log);
}

void PrintLidars(const TopicChoice& choice) {
  if (choice.further_lidars.empty()) {
    std::printf("would take: lidar: %s\n", choice.lidar.clouds->topic.name.c_str());
    return;
  }
  std::printf("would take: lidar %s (the reference; another by --cloud): %s\n",
              choice.lidar.name.c_str(), choice.lidar.clouds->topic.name.c_str());
  for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
    std::printf("would take: lidar %s: %s\n", lidar.name.c_str(), lidar.clouds->topic.name.c_str());
  }
}

int RunImport(const ImportFlags& flags, const PacketImport* packets) {
  if (IsPacketFile(flags.bag)) return RunPackets(flags, packets);
  for (const auto& [given, option] :
       {std::pair(flags.port != 0, "--port"), std::pair(flags.in_order, "--in-order"),
        std::pair(!flags.image_folders.empty(), "--images")}) {
    if (given) {
      throw UsageError(std::string(option) + " is of a recording of packets (.pcap, .pcapng)");
    }
  }
  CheckFlags(flags);
  const bool writes = !flags.out.empty();
  const RigWishes wishes = writes ? RigWishesOf(flags) : RigWishes();
  if (writes) RequireRoomForSession(flags.out);
  if (!flags.log.empty()) RequireNew(flags.log);
  const std::optional<LogRig> log_rig = LogRigOf(flags.session);
  const std::unique_ptr<BagReader> bag = OpenBag(flags.bag);
  BagSurvey survey = SurveyBag(bag.get(), ReadingProgress(*bag));
  PrintTopics(*bag, survey);
  TopicWishes topics{NamedTopics(flags.images), NamedTopics(flags.clouds)};
  topics.one_lidar = !flags.log.empty();
  topics.clouds_alone = topics.one_lidar && !log_rig;
  const TopicChoice choice = ChooseTopics(survey, topics);
  for (const std::string& line : choice.left_out) {
    std::printf("left out: %s\n", line.c_str());
  }
  if (!flags.log.empty()) {
    const CloudReader read_cloud = CloudsOf(flags, packets, choice, bag.get(), &survey)[0];
    return ImportLog(flags.log, log_rig, choice, read_cloud, bag.get());
  }
  if (!writes) {
    for (const TopicChoice::Camera& camera : choice.cameras) {
      std::printf("would take: camera %s: %s, lens: %s\n", camera.name.c_str(),
                  camera.images->topic.name.c_str(),
                  camera.info != nullptr ? camera.info->topic.name.c_str() : "none");
    }
    PrintLidars(choice);
    std::printf("next: add --board and --out, or --log\n");
    return EndsWith(true);
  }
  const std::vector<CloudReader> read_clouds = CloudsOf(flags, packets, choice, bag.get(), &survey);
  const BagRig rig = ReadRig(bag.get(), survey, choice, wishes);
  for (const std::string& line : rig.lines) std::printf("%s\n", line.c_str());
  std::printf("board: %s\n", DescribeBoard(rig.rig.target).c_str());
  std::vector<std::string> left_over;
  const std::vector<Moment> moments = MomentsOf(bag.get(), choice, rig.rig, flags, &left_over);
  const std::size_t views = WriteMoments(bag.get(), choice, rig.rig, moments, read_clouds,
                                         flags.out, PrintProgress, &left_over);
  for (const std::string& line : left_over) std::printf("left over: %s\n", line.c_str());
  std::printf("wrote %s: rig.textproto, %zu %s\n", flags.out.c_str(), views,
              views == 1 ? "view" : "views");
  return FinishSession(flags.out, WithoutLens(rig.rig));
}

}  // namespace

void AddImport(CommandLine* program, const PacketImport* packets) {
  auto flags = std::make_shared<ImportFlags>();
  CommandLine* verb = program->Verb(
      "import",
      "Makes a session directory of a bag, ready for `rgbdt calibrate`, or (--log) a log for\n"
      "`rgbdt map`, `refine`, `sync` and lcm-logplayer. A bag is MCAP (of ROS or with\n"
      "Foxglove's schemas), a ROS 2 bag (.db3, or the folder that holds it) or a ROS 1 bag; no "
      "ROS\n"
      "is needed. Without --board and --out it lists what is inside. Cameras, lenses "
      "(CameraInfo),\n"
      "guesses (tf_static) and the LIDAR are taken from the topics. Views are taken where the "
      "board\n"
      "stands still for a second, spread over the image. Exit code 1: also where a lens was to be\n"
      "found from the images and was not.\n"
      "A LIDAR's packets in the bag are decoded: Velodyne, Livox, RoboSense, Ouster and Hesai "
      "(with the "
      "bag's\n"
      "topic `metadata`, or --metadata).\n"
      "Of a recording of such packets (.pcap, .pcapng) and folders of images (--images) it makes\n"
      "a session as `rgbdt session` does; without images it writes each sweep as a PCD into "
      "--out,\n"
      "named by its time.\n"
      "Examples: rgbdt import drive.mcap\n"
      "          rgbdt import drive.mcap --board 8x6@0.095,0.85x0.61 --out out/session\n"
      "          rgbdt import drive.bag --board 11x8@0.1,1.2192x0.9144 --image rgb=/cam0/image_raw "
      "\\\n"
      "            --cloud /velodyne_points --every 5 --out out/session\n"
      "          rgbdt import two_lidars.mcap --cloud front=/front/points --cloud "
      "rear=/rear/points "
      "\\\n"
      "            --board 8x6@0.095,0.85x0.61 --out out/session\n"
      "          rgbdt import drive.mcap --log drive.lcmlog --session out/session\n"
      "          rgbdt import drive.pcap --metadata os1.json --images images --lens "
      "camera_info.yaml \\\n"
      "            --board 8x6@0.095,0.85x0.61 --out out/session\n"
      "          rgbdt import drive.pcap --metadata os1.json --out out/clouds",
      [flags, packets] { return RunImport(*flags, packets); });
  verb->Required("FILE", &flags->bag,
                 "the bag, or the recording; a folder stands for the bags in it");
  verb->Option("--board", &flags->board,
               "the board as for `rgbdt session`: SQUARESxSQUARES@SQUARE,WIDTHxHEIGHT in metres");
  verb->Option("--out", &flags->out, "the session directory to write");
  verb->Option(
      "--log", &flags->log,
      "in place of --board and --out: the log to write, of all clouds and images of the bag");
  verb->Option("--session", &flags->session,
               "of a log: the calibrated session whose rig was recorded; its cameras' names are\n"
               "those of the topics, or of --image. Without: a log of clouds alone");
  verb->Option(
      "--image", &flags->images,
      "[NAME=]TOPIC, a camera's images; given again for each camera. Without: every camera\n"
      "that is in the bag");
  verb->Option("--images", &flags->image_folders,
               "[NAME=]DIR of a recording of packets: a camera's folder of images, as for\n"
               "`rgbdt session`; given again for each camera");
  verb->Option(
      "--cloud", &flags->clouds,
      "[NAME=]TOPIC, a LIDAR's clouds or packets; given again for each LIDAR, the reference\n"
      "first. Without: every LIDAR whose clouds are in the bag or, without any, whose packets;\n"
      "each frame is one");
  verb->Option("--lens", &flags->lenses,
               "[NAME=]FILE[:PART], in the order of the cameras, in place of the bag's CameraInfo");
  verb->Flag("--pinhole", &flags->pinhole,
             "a lens that neither bag nor file says is a pinhole, found from the images");
  verb->Flag("--fisheye", &flags->fisheye, "the same, a fisheye");
  verb->Within("--every", &flags->every_s, 0, 1e6,
               "a view every so many seconds [s], still or not");
  verb->Option("--at", &flags->at,
               "a view at this time [s], since the bag's start or 1970; may be given again");
  verb->Option("--views", &flags->views, "of moments in which the board stands still: at most");
  verb->Within("--max-apart", &flags->max_apart_s, 0, 60,
               "how far an image and its cloud may be apart, by their headers or names [s]");
  verb->Option("--metadata", &flags->metadata,
               "[NAME=]FILE of packets: what an Ouster says of itself (JSON), or the angles of a\n"
               "Hesai or RoboSense (CSV); with its name for each of several LIDARs");
  verb->Flag("--in-order", &flags->in_order,
             "of a recording: the first image belongs to the first sweep and so on");
  verb->Option("--port", &flags->port,
               "of a recording: the UDP port of the LIDAR; 0: where its packets are most");
}

}  // namespace rgbdt
