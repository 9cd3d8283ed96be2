#include <vector>

#include "calib/files/schema/rig_file.h"
#include "services/messages/codec.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/fuzz/small_session.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;

constexpr Utime kBegin = 1'700'000'000'000'000;
constexpr Utime kPeriod = 100'000;  // of a sweep
constexpr int kLines = 10;

// Places in RandomMessages::OneOfEach.
enum Place : char {
  kLine = 0,
  kEncoder = 1,
  kImage = 2,
  kCloud = 3,
  kCalibration = 6,
  kFused = 7,
  kPose = 8,
  kMountCheck = 15
};
constexpr char kLater = '\xff';

std::string Sent(char place, const Message& message) {
  const Bytes bytes = Encode(message);
  return place + Piece({bytes.begin() + 8, bytes.end()});
}

// A corner of a room, in `beams` directions a line.
std::string RoomSweep(int number, int beams) {
  std::string sent;
  for (int line = 0; line < kLines; ++line) {
    CloudChunk chunk;
    chunk.cloud.sweep_utime = kBegin + kPeriod * number;
    chunk.cloud.first_line = line;
    chunk.cloud.lines = 1;
    chunk.cloud.beams = beams;
    for (int beam = 0; beam < beams; ++beam) {
      const float y = 0.2F * static_cast<float>(beam - beams / 2), z = 0.2F * (line - kLines / 2);
      const bool side = beam % 3 == 0;
      chunk.cloud.points.emplace_back(side ? y + 3 : 4, side ? 4 : y, beam % 3 == 1 ? -1 : z);
      chunk.cloud.utime.push_back(chunk.cloud.sweep_utime + kPeriod / beams * beam);
    }
    chunk.sweep_end = line == kLines - 1;
    chunk.sweep_lines = chunk.sweep_end ? kLines : 0;
    sent += Sent(kCloud, chunk);
  }
  return sent;
}

std::string Pose(Utime utime, double x) {
  StampedPose pose;
  pose.utime = utime;
  pose.source = "gps";
  pose.map_from_lidar.translation = {x, 0, 0};
  return Sent(kPose, pose);
}

// Of the small rig's colour camera.
std::string Colour(testing::RandomMessages* random, Utime utime) {
  Image image = random->Picture(PixelFormat::kBgr8);
  image.camera = "rgb";
  image.utime = utime;
  image.shutter_correcting = false;
  image.pixels = cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3));
  return Sent(kImage, image);
}

std::string Calibrated(testing::RandomMessages* random) {
  CalibrationMessage message = random->Calibrated();
  message.rig_hash = ParseRig(kSmallRig, "rig").hash;
  message.calibration = {};
  message.calibration.camera = "rgb";
  message.calibration.status = SolveStatus::kConverged;
  message.calibration.covariance = Matrix6d(Matrix6d::Identity() * 1e-6);
  return Sent(kCalibration, message);
}

std::string Drive(testing::RandomMessages* random, int beams) {
  std::string sent = Calibrated(random);
  for (int i = 0; i < 3; ++i) {
    sent += Pose(kBegin + kPeriod * i, 0.1 * i) + Colour(random, kBegin + kPeriod * i);
    sent += RoomSweep(i, beams);
  }
  return sent + kLater;
}

std::string Turned() {
  std::string sent;
  for (int i = 0; i < 12; ++i) {
    const Utime utime = kBegin + 50'000 * i;
    EncoderReading reading{utime, i, 10'000 * i, kBegin};
    LineScan line;
    line.utime = utime + 1000;
    line.seq = i;
    line.beam_period_s = 1e-4;
    line.first_angle_rad = -1;
    line.angle_step_rad = 0.1;
    line.range.assign(20, 4);
    line.intensity.assign(20, 0.5F);
    sent += Sent(kEncoder, reading) + Sent(kLine, line);
  }
  return sent + Sent(kEncoder, EncoderReading{kBegin + 5'000'000, 12, 0, kBegin + 5'000'000});
}

std::string Fused(testing::RandomMessages* random) {
  std::string sent;
  for (int i = 0; i < 3; ++i) {
    RgbdtCloud cloud = random->Fused();
    cloud.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0}};
    cloud.frame_utime = kBegin;
    cloud.whole_sweep = i == 2;
    const auto behind_all = static_cast<char>(random->OneOfEach().size());  // where sweeps are
    sent += Sent(cloud.whole_sweep ? behind_all : char{kFused}, cloud);
  }
  return sent + kLater;
}

// A view's capture, what came of it, and how the solver judges it.
std::string Captured(testing::RandomMessages* random) {
  SessionCommand command;
  command.command = 1;
  command.verb = SessionVerb::kCapture;
  command.utime = kBegin + kPeriod;
  command.view = "0001";
  command.sweep_utime = kBegin;
  Image thermal = random->Picture(PixelFormat::kMono16);
  thermal.camera = "thermal";
  thermal.utime = command.utime;
  thermal.shutter_correcting = false;
  thermal.pixels = cv::Mat(3, 4, CV_16UC1, cv::Scalar(8000));
  ViewDetection detection = random->Seen();
  detection.view = command.view;
  detection.sweep_utime = kBegin;
  detection.images.clear();
  MountCheck check = random->Watched();
  check.camera = "rgb";
  constexpr char kCommand = 10, kDetection = 5, kThermal = static_cast<char>(0x80 | kImage);
  return Sent(kCommand, command) + RoomSweep(0, 6) + Colour(random, command.utime) +
         Sent(kThermal, thermal) + Sent(kDetection, detection) + Calibrated(random) +
         Sent(kMountCheck, check) + kLater;
}

// A byte for the node and its rig (nodes.cc, viewer_node.cc), and the messages.
void AddNodes(Inputs* seeds, Inputs* viewer_seeds) {
  testing::RandomMessages random(1);
  const std::string few = Drive(&random, 6), fused = Fused(&random);
  constexpr char kNodes = 6;
  for (char node = 0; node < kNodes; ++node) {
    const std::string number = std::to_string(node);
    (*seeds)["drive" + number] = node + few;
    (*seeds)["fused" + number] = node + fused;
    std::string each(1, node);
    char place = 0;
    for (const Message& message : random.OneOfEach()) each += Sent(place++, message);
    (*seeds)["each" + number] = each;
    if (node < 2) (*viewer_seeds)["each" + number] = each;
  }
  (*viewer_seeds)["drive"] = '\0' + few;
  (*viewer_seeds)["fused"] = '\0' + fused;
  (*viewer_seeds)["captured"] = '\0' + Captured(&random);
  (*seeds)["turned"] = static_cast<char>(kNodes) + Turned();
  (*seeds)["odometry"] = '\4' + Drive(&random, 60);
}

std::string Chunk(unsigned flags, unsigned vectors, unsigned first, unsigned told, unsigned lines,
                  unsigned beams) {
  std::string bytes;
  const auto word = [&](unsigned value) {
    bytes += static_cast<char>(value >> 8);
    bytes += static_cast<char>(value);
  };
  bytes += static_cast<char>(flags);
  bytes += static_cast<char>(vectors);
  word(first);
  word(told);
  bytes += static_cast<char>(lines);
  word(beams);
  return bytes;
}

// As sweep_collector.cc takes them: a byte, by which large sweeps are joined, too, and chunks.
void AddChunks(Inputs* seeds) {
  constexpr unsigned kOrganised = 4, kEnd = 8, kLong = 32;
  constexpr char kSmall = 0, kLarge = 0x7f;
  for (const unsigned organised : {0U, kOrganised}) {
    const std::string name = organised != 0 ? "lines" : "stretches";
    const std::string two =
        kSmall + Chunk(organised, 31, 0, 0, 1, 9) + Chunk(organised, 31, 1, 0, 1, 9);
    (*seeds)[name] = two + Chunk(organised | kEnd, 31, 2, 3, 1, 9);
    (*seeds)[name + "_turned"] =
        kSmall + Chunk(organised | kEnd, 0, 0, 2, 0, 0) + Chunk(organised, 0, 1, 0, 1, 9);
    (*seeds)[name + "_told_more"] = two + Chunk(organised | kEnd, 31, 0, 90, 0, 0);
    (*seeds)[name + "_other"] = two + Chunk(organised, 1, 3, 0, 1, 9) +
                                Chunk(organised, 31, 3, 0, 1, 8) +
                                Chunk(organised | kEnd, 31, 0, 2, 0, 60'000);
  }
  (*seeds)["lines_far"] =
      kLarge + Chunk(kOrganised, 31, 0, 0, 1, 9) + Chunk(kOrganised | kEnd, 31, 0, 20'000, 0, 0);
  (*seeds)["stretches_far"] =
      kLarge + Chunk(0, 31, 0, 0, 1, 200) + Chunk(kEnd | kLong, 31, 0, 60'000, 0, 0);
}

}  // namespace

void AddNodeSeeds(Seeds* seeds) {
  AddNodes(&(*seeds)["nodes"], &(*seeds)["viewer_node"]);
  AddChunks(&(*seeds)["sweep_collector"]);
}

}  // namespace rgbdt::fuzz
