#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/check_writable.h"
#include "calib/files/import/board_text.h"
#include "calib/files/import/folders.h"
#include "calib/methods/board_check.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/import/import_bag.h"
#include "services/import/still.h"
#include "services/rgbdt/import_to_log.h"
#include "services/rgbdt/packet_import.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct ImportFlags {
  std::string bag, board, out, log, session, cloud, metadata;
  std::vector<std::string> images, lenses, at;
  bool pinhole = false, fisheye = false;
  double every_s = 0, max_apart_s = 0.1;
  int views = 24, port = 0;
};

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
TopicWishes WishesOf(const ImportFlags& flags) {
  TopicWishes wishes;
  wishes.cloud = flags.cloud;
  for (const std::string& text : flags.images) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      wishes.images.emplace_back("", text);
    } else {
      wishes.images.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  }
  return wishes;
}

RigWishes RigWishesOf(const ImportFlags& flags) {
  RigWishes wishes;
  wishes.board = ParseBoard(flags.board);
  for (const std::string& text : flags.lenses) wishes.lenses.push_back(LensFileOf(text));
  if (flags.pinhole) wishes.model = Lens::Model::kPinhole;
  if (flags.fisheye) wishes.model = Lens::Model::kFisheye;
  return wishes;
}

// Seconds since the bag's start, or since 1970.
std::vector<Utime> TimesOf(const std::vector<std::string>& texts, Utime start) {
  constexpr double kSince1970 = 1e8;
  std::vector<Utime> times;
  for (const std::string& text : texts) {
    std::size_t read = 0;
    double seconds = -1;
    try {
      seconds = std::stod(text, &read);
    } catch (const std::exception&) {
      read = 0;
    }
    if (read == 0 || read != text.size() || !(seconds >= 0 && seconds < 1e11)) {
      throw UsageError("--at is \"" + text + "\"; expected seconds since the bag's start, or 1970");
    }
    times.push_back(FromSeconds(seconds) + (seconds < kSince1970 ? start : 0));
  }
  return times;
}

std::vector<std::string> WithoutLens(const Rig& rig) {
  std::vector<std::string> names;
  for (const CameraSpec& camera : rig.cameras) {
    if (!camera.lens.known()) names.push_back(camera.name);
  }
  return names;
}

std::size_t ReferenceCamera(const Rig& rig) {
  const auto colour =
      std::find_if(rig.cameras.begin(), rig.cameras.end(),
                   [](const CameraSpec& camera) { return camera.kind == CameraKind::kColor; });
  return colour == rig.cameras.end() ? 0 : static_cast<std::size_t>(colour - rig.cameras.begin());
}

// Counts that are of inner corners are told; why else the board is in none of some images.
std::string WhyNotSeen(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                       const std::vector<Stamped>& stamped) {
  constexpr std::size_t kImages = 3;
  const std::size_t camera = ReferenceCamera(rig);
  std::vector<Image> images;
  for (std::size_t i = 0; i < std::min(kImages, stamped.size()); ++i) {
    const std::size_t at = (2 * i + 1) * stamped.size() / (2 * std::min(kImages, stamped.size()));
    try {
      images.push_back(ReadImage(bag, choice.cameras[camera], rig.cameras[camera], stamped[at]));
    } catch (const InputError&) {  // told where it is to be written
    }
  }
  const BoardCheck check = CheckBoard(rig.cameras[camera], rig.target, images);
  if (check.instead) {
    throw InputError("--board: " + rig.cameras[camera].name + ": " + OtherBoard(rig.target, check));
  }
  return check.found ? "" : check.why;
}

// When the board stands still.
std::vector<Utime> StillTimes(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                              const ImportFlags& flags) {
  if (!rig.target.HasPattern()) {
    throw InputError("a plain board is not looked for in the images: say --every or --at");
  }
  const std::size_t camera = ReferenceCamera(rig);
  const std::string& name = rig.cameras[camera].name;
  const StillMoments still = FindStillMoments(bag, choice.cameras[camera], rig.cameras[camera],
                                              rig.target, static_cast<std::size_t>(flags.views),
                                              Tenths("looking for the board in " + name));
  if (still.found == 0) {
    const std::string why = WhyNotSeen(bag, choice, rig, choice.cameras[camera].images->stamped);
    throw InputError("the board is in none of " + std::to_string(still.looks) + " images of " +
                     name + (why.empty() ? "" : ": " + why) +
                     "; --every or --at takes views anyway");
  }
  std::printf("board found in %zu of %zu images of %s; it stood still %zu times, %zu are taken\n",
              still.found, still.looks, name.c_str(), still.stands, still.times.size());
  if (still.times.empty()) {
    throw InputError("the board never stood still for a second (less than " +
                     Fixed(kStillForSecondPx, 1) + " px in " + name +
                     "); --every or --at takes views anyway");
  }
  return still.times;
}

std::vector<Moment> MomentsOf(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                              const ImportFlags& flags, std::vector<std::string>* left_over) {
  const bool told = flags.every_s > 0 || !flags.at.empty();
  const std::vector<Utime> times = !flags.at.empty()   ? TimesOf(flags.at, StartOf(choice))
                                   : flags.every_s > 0 ? EverySeconds(choice, flags.every_s)
                                                       : StillTimes(bag, choice, rig, flags);
  std::vector<Moment> moments = PairAt(choice, times, flags.max_apart_s, left_over);
  if (!told || !rig.target.HasPattern()) return moments;
  std::vector<Stamped> images;
  for (const Moment& moment : moments) {
    const auto& image = moment.images[ReferenceCamera(rig)];
    if (image) images.push_back(*image);
  }
  const std::string why = images.empty() ? "" : WhyNotSeen(bag, choice, rig, images);
  if (!why.empty()) {
    std::printf("warning: the board is in none of the images of %s looked at: %s\n",
                rig.cameras[ReferenceCamera(rig)].name.c_str(), why.c_str());
  }
  return moments;
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

// A recording holds no images: what is of these makes no sense with it.
int RunPackets(const ImportFlags& flags, const PacketImport* packets) {
  const bool of_bags = !flags.board.empty() || !flags.log.empty() || !flags.session.empty() ||
                       !flags.cloud.empty() || !flags.images.empty() || !flags.lenses.empty() ||
                       !flags.at.empty() || flags.every_s > 0 || flags.pinhole || flags.fisheye;
  if (of_bags) {
    throw UsageError(
        flags.bag +
        ": is a recording of packets, without images, so no --board and the like; expected --out, "
        "--metadata and --port alone, then rgbdt session --clouds with the images");
  }
  if (packets == nullptr) {
    throw InputError(flags.bag + ": is a recording of packets; this build is without drivers");
  }
  return packets->recording({flags.bag, flags.metadata, flags.out, flags.port});
}

bool IsPacketFile(const std::string& path) {
  const std::string end = std::filesystem::path(path).extension().string();
  return end == ".pcap" || end == ".pcapng";
}

// Messages, or packets, of which then the sweeps are known.
CloudReader CloudsOf(const ImportFlags& flags, const PacketImport* packets,
                     const TopicChoice& choice, BagReader* bag, BagSurvey* survey) {
  const std::string& name = choice.cloud->topic.name;
  if (choice.cloud->data != BagData::kPackets) {
    if (flags.metadata.empty()) return CloudMessages(bag, *choice.cloud);
    throw UsageError("--metadata is of packets; " + name + " holds clouds");
  }
  if (packets == nullptr) {
    throw InputError(name + ": holds a LIDAR's packets; this build is without drivers");
  }
  return packets->in_bag({flags.bag, flags.metadata, survey, survey->Find(name)});
}

// A log may be an hour's drive, or the bag itself.
void RequireNew(const std::filesystem::path& log) {
  if (std::filesystem::exists(log)) {
    throw InputError(log.string() + " is there already; remove it or name another --log");
  }
  CheckWritable(log);
}

int RunImport(const ImportFlags& flags, const PacketImport* packets) {
  if (IsPacketFile(flags.bag)) return RunPackets(flags, packets);
  if (flags.port != 0) {
    throw UsageError("--port is of a recording of packets (.pcap, .pcapng)");
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
  TopicWishes topics = WishesOf(flags);
  topics.clouds_alone = !flags.log.empty() && !log_rig;
  const TopicChoice choice = ChooseTopics(survey, topics);
  for (const std::string& line : choice.left_out) {
    std::printf("left out: %s\n", line.c_str());
  }
  if (!flags.log.empty()) {
    const CloudReader read_cloud = CloudsOf(flags, packets, choice, bag.get(), &survey);
    return ImportLog(flags.log, log_rig, choice, read_cloud, bag.get());
  }
  if (!writes) {
    for (const TopicChoice::Camera& camera : choice.cameras) {
      std::printf("would take: camera %s: %s, lens: %s\n", camera.name.c_str(),
                  camera.images->topic.name.c_str(),
                  camera.info != nullptr ? camera.info->topic.name.c_str() : "none");
    }
    std::printf("would take: lidar: %s\nnext: add --board and --out, or --log\n",
                choice.cloud->topic.name.c_str());
    return EndsWith(true);
  }
  const CloudReader read_cloud = CloudsOf(flags, packets, choice, bag.get(), &survey);
  const BagRig rig = ReadRig(bag.get(), survey, choice, wishes);
  for (const std::string& line : rig.lines) std::printf("%s\n", line.c_str());
  std::printf("board: %s\n", DescribeBoard(rig.rig.target).c_str());
  std::vector<std::string> left_over;
  const std::vector<Moment> moments = MomentsOf(bag.get(), choice, rig.rig, flags, &left_over);
  const std::size_t views = WriteMoments(bag.get(), choice, rig.rig, moments, read_cloud, flags.out,
                                         PrintProgress, &left_over);
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
      "Of a recording of such packets (.pcap, .pcapng) it writes each sweep as a PCD into --out, "
      "named by its time, for\n"
      "`rgbdt session --clouds`.\n"
      "Examples: rgbdt import drive.mcap\n"
      "          rgbdt import drive.mcap --board 8x6@0.095,0.85x0.61 --out out/session\n"
      "          rgbdt import drive.bag --board 11x8@0.1,1.2192x0.9144 --image rgb=/cam0/image_raw "
      "\\\n"
      "            --cloud /velodyne_points --every 5 --out out/session\n"
      "          rgbdt import drive.mcap --log drive.lcmlog --session out/session\n"
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
  verb->Option("--cloud", &flags->cloud, "topic of the clouds, where there are several");
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
               "how far an image and its cloud may be apart, by their headers [s]");
  verb->Option("--metadata", &flags->metadata,
               "of packets: what an Ouster says of itself (JSON), or the angles of a Hesai or "
               "RoboSense (CSV)");
  verb->Option("--port", &flags->port,
               "of a recording: the UDP port of the LIDAR; 0: where its packets are most");
}

}  // namespace rgbdt
