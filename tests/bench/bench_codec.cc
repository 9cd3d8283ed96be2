// Encoding and decoding each message of the bus, at the sizes that it has on a rig, and signing and
// checking those that are signed; beside copying its bytes into new memory. See measure.h for
// flags.
#include <algorithm>
#include <cctype>
#include <limits>
#include <memory>
#include <stdexcept>

#include "calib/files/schema/report_file.h"
#include "calib/methods/calibrate.h"
#include "calib/scan_assembly/line_to_cloud.h"
#include "services/bus/signature.h"
#include "services/messages/codec.h"
#include "tests/bench/measure.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/turning_scanner.h"
#include "tests/numbers.h"
#include "tests/study/paired_sessions.h"

namespace rgbdt::bench {
namespace {

// A line as the assembler sends it, misses and all.
CloudChunk LineChunk() {
  const LineScan line = TurningScanner(kJune2015).Line(0);
  const std::vector<double> angles(line.range.size(), 0.1);
  CloudChunk chunk;
  chunk.cloud = LineToCloud(*MakeBenchRig().rig.lidar.turned_scanner, line, angles);
  chunk.cloud.sweep_utime = kJune2015;
  return chunk;
}

CloudChunk ChunkOf(std::int64_t points) {
  CloudChunk chunk;
  chunk.cloud = ScannedRoom(kAllRound, points, kJune2015);
  return chunk;
}

RgbdtCloud FusedOf(std::int64_t points) {
  const Cloud cloud = ScannedRoom(kAllRound, points, kJune2015);
  RgbdtCloud fused;
  fused.sweep_utime = kJune2015;
  fused.cameras = {"rgb", "thermal"};
  fused.calibration_utime = {kJune2015, kJune2015};
  fused.points = cloud.points;
  fused.intensity = cloud.intensity;
  fused.utime = cloud.utime;
  fused.rgb.assign(cloud.size(), {120, 130, 140});
  fused.temperature_k.assign(cloud.size(), 300.5F);
  fused.temperature_sigma_k.assign(cloud.size(), 0.05F);
  fused.thermal_counts.assign(cloud.size(), 7000);
  fused.valid.assign(cloud.size(), 3);
  return fused;
}

Status StatusOfANode() {
  Status status;
  status.process = "fuser";
  status.utime = kJune2015;
  status.ready = true;
  status.text = "fusing";
  status.last_problem = "RGB_IMAGE: the message is cut short";
  for (const char* name : {"points", "coloured", "shutter frames", "received", "dropped", "gaps"}) {
    status.counters.emplace_back(name, 123456);
  }
  return status;
}

SessionCommand Capture() {
  SessionCommand command;
  command.utime = kJune2015;
  command.verb = SessionVerb::kCapture;
  command.view = "0007";
  command.sweep_utime = kJune2015;
  command.picked_cameras = {"thermal"};
  return command;
}

SessionEvent Progress() {
  SessionEvent event;
  event.utime = kJune2015;
  event.source = "simulator";
  event.kind = EventKind::kProgress;
  event.text = "sweeping";
  event.sweep_utime = kJune2015;
  event.fraction = 0.5;
  return event;
}

CornerSelection Picks() {
  CornerSelection picks;
  picks.camera = "thermal";
  picks.utime = picks.image_utime = kJune2015;
  picks.corners = {Eigen::Vector2d{10, 10}, {90, 10}, {90, 80}, {10, 80}};
  return picks;
}

StampedPose PoseOfTheRig() {
  StampedPose pose;
  pose.utime = kJune2015;
  pose.source = "odometry";
  return pose;
}

// The detector's detection of a view, and the solver's report of the session.
Messages FromASession() {
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    study::PairedOptions options;
    options.paper = false;
    const auto session = study::MakePairedSession(options, seed);
    if (!session) continue;
    ViewDetection detection = session->by_boards.front();
    for (ImageDetection& image : detection.images) image.utime = kJune2015;
    ReportText report;
    report.utime = kJune2015;
    report.json = ReportToJson(Calibrate(session->rig, session->by_boards));
    return {detection, report};
  }
  throw std::runtime_error("no session has room for the board");
}

Messages OneOfEach() {
  const BenchRig rig = MakeBenchRig();
  const TurningScanner scanner(kJune2015);
  Messages messages = {scanner.Line(0), scanner.Reading(0), LineChunk(),
                       ChunkOf(10'000), ChunkOf(100'000),   FusedOf(400),
                       FusedOf(5'000),  FusedOf(50'000),    Picks(),
                       PoseOfTheRig(),  rig.text,           Capture(),
                       Progress(),      StatusOfANode(),    rig.Calibrations(kJune2015).front()};
  for (const CameraSpec& camera : rig.rig.cameras) {
    messages.emplace_back(PictureOf(camera, kJune2015, 0));
  }
  for (Message& message : FromASession()) messages.push_back(std::move(message));
  return messages;
}

// "cloud"; images of all cameras are one row.
std::string RowOf(const Message& message) {
  std::string row = std::holds_alternative<Image>(message) ? "image" : ChannelOf(message);
  std::transform(row.begin(), row.end(), row.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return row;
}

void RegisterMessage(const Message& made) {
  const auto message = std::make_shared<const Message>(made);
  const auto bytes = std::make_shared<const Bytes>(Encode(made));
  const auto size = static_cast<std::int64_t>(bytes->size());
  const auto add = [&](const std::string& what, const char* who,
                       const std::function<void()>& work) {
    Register({what + "_" + RowOf(made), who, size, "bytes"}, [work] { return work; });
  };
  const auto copy = [bytes] {
    Bytes copied(*bytes);
    benchmark::DoNotOptimize(copied.data());
  };
  add("encode", "rgbdt", [message] {
    Bytes encoded = Encode(*message);
    benchmark::DoNotOptimize(encoded.data());
  });
  add("encode", "memcpy", copy);
  add("decode", "rgbdt", [bytes, channel = ChannelOf(made)] {
    Message decoded = Decode(channel, bytes->data(), bytes->size());
    benchmark::DoNotOptimize(decoded);
  });
  add("decode", "memcpy", copy);
  if (!IsSignedChannel(ChannelOf(made))) return;
  // What a key costs a message on both its ends: signed by one process, checked by another.
  const auto signer = std::make_shared<MessageSigner>(BusKey());
  const auto check = std::make_shared<SignatureCheck>(BusKey());
  add("sign", "rgbdt", [bytes, signer, check, channel = ChannelOf(made)] {
    Bytes message(*bytes);
    signer->Sign(channel, kJune2015, &message);
    if (!check->WhyNot(channel, message.data(), message.size(), kJune2015).empty()) {
      throw std::runtime_error("a signed message was refused");
    }
  });
  add("sign", "memcpy", copy);
}

}  // namespace
}  // namespace rgbdt::bench

int main(int argc, char** argv) {
  return rgbdt::bench::Main(argc, argv, [](std::int64_t) {
    for (const rgbdt::Message& message : rgbdt::bench::OneOfEach()) {
      rgbdt::bench::RegisterMessage(message);
    }
  });
}
