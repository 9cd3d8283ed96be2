#include "services/replay/waved_log.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"

namespace rgbdt {
namespace {

/// The log's rig and its last calibration of each camera: they come once a second, and later than
/// the first sweeps.
struct Known {
  std::optional<Rig> rig;
  std::map<std::string, CalibrationMessage> cameras;
};

Known FindKnown(const std::string& path) {
  Known known;
  LogReader log(path);
  while (const auto event = log.Next()) {
    if (event->channel != "RIG" && event->channel != "CALIBRATION") continue;
    try {
      const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      if (const auto* text = std::get_if<RigText>(&message); text != nullptr && !known.rig) {
        known.rig = ParseRig(text->text, "RIG");
      }
      if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
        known.cameras[calibration->calibration.camera] = *calibration;
      }
    } catch (const InputError&) {  // no rig or calibration then
    }
  }
  return known;
}

WaveReader ReaderFor(const std::string& path, const Known& known,
                     const std::optional<Calibration>& calibration,
                     const WavedLogOptions& options) {
  if (!known.rig) throw InputError(path + ": no RIG in this log; record that channel, too");
  try {
    return {*known.rig, calibration ? calibration : CalibrationOf(known.cameras), options};
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
}

}  // namespace

std::optional<Calibration> CalibrationOf(const std::map<std::string, CalibrationMessage>& cameras) {
  if (cameras.empty()) return std::nullopt;
  Calibration calibration;
  for (const auto& [name, message] : cameras) {
    calibration.method = message.method;
    calibration.rig_hash = message.rig_hash;
    calibration.utime = std::max(calibration.utime, message.utime);
    calibration.cameras.push_back(message.calibration);
  }
  return calibration;
}

WavedLog ReadWavedLog(const std::string& path, const std::optional<Calibration>& calibration,
                      const WavedLogOptions& options, const std::function<void(double)>& progress) {
  WaveReader reader = ReaderFor(path, FindKnown(path), calibration, options);
  LogReader log(path);
  std::vector<std::string> problems;
  std::int64_t dropped = 0;
  std::string last_problem;
  while (const auto event = log.Next()) {
    if (progress) progress(static_cast<double>(log.position()) / static_cast<double>(log.size()));
    if (event->channel != "CLOUD" && !IsImageChannel(event->channel)) continue;
    try {
      reader.Take(Decode(event->channel, event->bytes.data(), event->bytes.size()));
    } catch (const InputError& error) {  // as a process does: dropped and counted
      ++dropped;
      last_problem = error.what();
    }
    if (!reader.Full()) continue;
    problems.push_back("what comes after " + std::to_string(reader.board().sweeps.size()) +
                       " sweeps was not read: that is enough");
    break;
  }
  if (dropped > 0) {
    problems.push_back(std::to_string(dropped) + " messages dropped; the last: " + last_problem);
  }
  if (log.unreadable_bytes() > 0) {
    problems.push_back(std::to_string(log.unreadable_bytes()) +
                       " bytes belong to no whole message");
  }
  if (reader.board().sweeps.empty()) {
    throw InputError(path + ": no whole sweep (CLOUD) with times in this log" +
                     (last_problem.empty() ? "" : "; last problem: " + last_problem));
  }
  WavedLog read = reader.Finish();
  read.problems = std::move(problems);
  return read;
}

}  // namespace rgbdt
