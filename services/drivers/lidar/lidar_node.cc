#include "services/drivers/lidar/lidar_node.h"

#include <algorithm>

#include "calib/model/errors.h"
#include "calib/model/recording.h"
#include "services/drivers/hokuyo/scip_scanner.h"
#include "services/drivers/lidar/internal/pcd_folder.h"
#include "services/drivers/packets/packet_source.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

template <typename Driver>
class SourceOf : public LidarNode::Source {
 public:
  template <typename Device>
  SourceOf(const Device& device, bool sweeps, bool live)
      : driver_(device), sweeps_(sweeps), live_(live) {}
  void Serve(DeviceThread& thread) override { driver_.Serve(thread); }
  const DeviceReport& report() const override { return driver_.report(); }
  bool sweeps() const override { return sweeps_; }
  bool live() const override { return live_; }

 private:
  Driver driver_;
  bool sweeps_, live_;
};

std::unique_ptr<LidarNode::Source> MakeSource(const LidarSpec& lidar) {
  const bool live = !IsRecording(lidar);
  if (const auto* hokuyo = std::get_if<HokuyoDevice>(&lidar.device)) {
    return std::make_unique<SourceOf<ScipScanner>>(*hokuyo, false, live);
  }
  if (const auto* velodyne = std::get_if<VelodyneDevice>(&lidar.device)) {
    return std::make_unique<SourceOf<PacketSource>>(*velodyne, true, live);
  }
  if (const auto* packets = std::get_if<PacketLidarDevice>(&lidar.device)) {
    return std::make_unique<SourceOf<PacketSource>>(*packets, true, live);
  }
  if (const auto* folder = std::get_if<PcdFolderDevice>(&lidar.device)) {
    return std::make_unique<SourceOf<PcdFolder>>(*folder, true, live);
  }
  throw InputError(
      "the rig's lidar names no device; add one of these to its lidar { ... }:\n"
      "  hokuyo { address: \"192.168.0.10\" }\n"
      "  velodyne { model: VLP16 }\n"
      "  ouster { metadata: \"os1.json\" }\n"
      "  hesai { metadata: \"angles.csv\" }\n"
      "  livox { }\n"
      "  robosense { }\n"
      "  pcd_folder { folder: \"clouds\" }\n"
      "or publish LINE_SCAN or CLOUD from a program of your own (scripts/examples/README.md)");
}

SessionEvent EventOf(std::int64_t command, EventKind kind, const std::string& text) {
  SessionEvent event;
  event.command = command;
  event.source = "lidar";
  event.kind = kind;
  event.text = text;
  return event;
}

}  // namespace

LidarNode::LidarNode(const LidarSpec& lidar) : source_(MakeSource(lidar)) {
  thread_ = std::make_unique<DeviceThread>(
      [source = source_.get()](DeviceThread& thread) { source->Serve(thread); });
}

LidarNode::~LidarNode() = default;

std::vector<std::string> LidarNode::Subscriptions() const {
  if (!source_->sweeps()) return {};
  return {"SESSION_COMMAND"};
}

Messages LidarNode::Handle(const Message& message) {
  const auto* command = std::get_if<SessionCommand>(&message);
  if (command == nullptr || !source_->sweeps()) return {};
  if (command->verb == SessionVerb::kReset) pending_.Clear();
  if (command->verb == SessionVerb::kSweep) {
    pending_.Add(command->command, source_->report().sweep_begun(), Now());
  }
  return {};
}

std::optional<PendingSweeps::Clocks> LidarNode::Now() const {
  if (!source_->live()) return std::nullopt;
  return PendingSweeps::Clocks{HostUtime(), SteadyUtime()};
}

void LidarNode::AnswerWith(const CloudChunk& chunk, Messages* messages) {
  const Utime sweep = chunk.cloud.sweep_utime;
  for (const std::int64_t command : pending_.TakeAnswered(sweep, Now())) {
    SessionEvent event = EventOf(command, EventKind::kDone, "sweep complete");
    event.utime = chunk.cloud.utime.empty() ? sweep : std::max(sweep, chunk.cloud.utime.back());
    event.sweep_utime = sweep;
    event.fraction = 1;
    messages->push_back(event);
  }
}

void LidarNode::FailPending(Messages* messages) {
  for (const std::int64_t command : pending_.TakeAll()) {
    messages->push_back(
        EventOf(command, EventKind::kFailed, "the recording has ended: no sweep begins any more"));
  }
}

Messages LidarNode::Advance(Utime /*now*/) {
  Messages messages;
  for (Message& message : TakeFrom(thread_.get())) {
    const auto* chunk = std::get_if<CloudChunk>(&message);
    Messages answers;
    if (chunk != nullptr && chunk->sweep_end) AnswerWith(*chunk, &answers);
    messages.push_back(std::move(message));
    for (Message& answer : answers) messages.push_back(std::move(answer));
  }
  if (thread_->ended()) FailPending(&messages);
  return messages;
}

}  // namespace rgbdt
