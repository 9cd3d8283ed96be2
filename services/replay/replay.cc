#include "services/replay/replay.h"

#include <algorithm>

#include "calib/model/errors.h"
#include "calib/model/said_again.h"
#include "services/messages/codec.h"
#include "services/messages/header.h"
#include "services/messages/image_channel.h"

namespace rgbdt {
namespace {

CalibrateOptions OptionsOf(const std::string& method) {
  CalibrateOptions options;
  options.method = method;
  return options;
}

// What sensors, people and the session said.
bool IsInput(const std::string& channel) {
  return channel == "RIG" || channel == "LINE_SCAN" || channel == "ENCODER" ||
         channel == "CORNER_SELECTION" || channel == "LEFT_OUT_VIEWS" ||
         channel == "SESSION_COMMAND" || channel == "POSE" || IsImageChannel(channel);
}

// Said for a process that was started anew, or to which the network did not bring it.
bool IsForWhoWasAway(const std::string& channel, const Bytes& bytes) {
  if (channel == "CLOUD" || IsImageChannel(channel)) {
    return HeaderOf(bytes.data(), bytes.size()).value_or(Header()).seq == kSaidAgain;
  }
  if (channel != "SESSION_COMMAND") return false;
  try {
    const auto command = std::get<SessionCommand>(Decode(channel, bytes.data(), bytes.size()));
    return command.verb == SessionVerb::kGoOn || command.verb == SessionVerb::kSayView;
  } catch (const InputError&) {
    return false;  // counted by who cannot decode it
  }
}

}  // namespace

Replay::Replay(const std::string& method, Use use)
    : detector_(method),
      solver_(OptionsOf(method)),
      fuser_(FuserNode::Ranges::kAsMeasured, use),
      assembler_runner_(&assembler_, &bus_),
      detector_runner_(&detector_, &bus_),
      solver_runner_(&solver_, &bus_),
      fuser_runner_(&fuser_, &bus_),
      runners_{&assembler_runner_, &detector_runner_, &solver_runner_, &fuser_runner_} {}

bool Replay::IsOfUse(const std::string& channel) {
  has_lines_ |= channel == "LINE_SCAN";
  has_session_ |= channel == "SESSION_COMMAND";
  // A log of clouds only (a 3D LIDAR) has no lines; one with lines gets its clouds from them.
  if (channel == "CLOUD") return !has_lines_;
  // A log of a session gets its calibration from its views; any other brings it along.
  if (channel == "CALIBRATION") return !has_session_;
  return IsInput(channel);
}

bool Replay::Take(const std::string& channel, const Bytes& bytes) {
  if (!IsOfUse(channel) || IsForWhoWasAway(channel, bytes)) return false;
  took_calibration_ |= channel == "CALIBRATION";
  bus_.Publish(channel, bytes);
  bus_.Run();
  Utime now = 0;
  for (const NodeRunner* runner : runners_) now = std::max(now, runner->newest_utime());
  for (NodeRunner* runner : runners_) runner->Advance(now);
  bus_.Run();
  return true;
}

void Replay::Finish() {
  // Clouds that wait for poses which the log does not have.
  constexpr Utime kLong = 1000 * kMicrosecondsPerSecond;
  const Utime now = fuser_runner_.newest_utime();
  fuser_runner_.Advance(now);
  fuser_runner_.Advance(now + kLong);
  bus_.Run();
}

}  // namespace rgbdt
