#include "services/replay/scanner_sweeps.h"

#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/assembler.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

const TurnedScanner& ScannerOf(const Rig& rig, const std::string& where) {
  if (rig.lidar.turned_scanner) return *rig.lidar.turned_scanner;
  throw InputError(where +
                   ": the rig's lidar has no turned_scanner, so there is no geometry of it "
                   "to find");
}

ScannerSweeps FromSession(const std::string& dir) {
  const Session session = OpenSession(dir, LensNeed::kMayBeUnknown);
  const TurnedScanner& scanner = ScannerOf(session.rig, dir);
  ScannerSweeps read;
  read.rig = session.rig;
  for (const std::string& view : session.views) {
    try {
      read.sweeps.push_back(BeamsOfCloud(scanner, ReadCloud(session, view)));
      read.names.push_back(view);
    } catch (const InputError& error) {
      read.problems.push_back("view " + view + ": " + error.what());
    }
  }
  return read;
}

/// What a log says of the scanner.
struct ScannerLog {
  std::optional<Rig> rig;
  std::vector<EncoderReading> readings;
  std::vector<LineScan> lines;
  std::int64_t dropped = 0, unreadable_bytes = 0;
  std::string last_problem;

  void Take(const Message& message) {
    if (const auto* text = std::get_if<RigText>(&message)) {
      if (!rig) rig = ParseRig(text->text, "RIG", LensNeed::kMayBeUnknown);
    } else if (const auto* reading = std::get_if<EncoderReading>(&message)) {
      readings.push_back(*reading);
    } else if (const auto* line = std::get_if<LineScan>(&message)) {
      lines.push_back(*line);
    }
  }
};

ScannerLog ReadLog(const std::string& path) {
  LogReader log(path);
  ScannerLog read;
  while (const auto event = log.Next()) {
    const std::string& channel = event->channel;
    if (channel != "RIG" && channel != "LINE_SCAN" && channel != "ENCODER") continue;
    try {
      read.Take(Decode(channel, event->bytes.data(), event->bytes.size()));
    } catch (const InputError& error) {  // as a process does: dropped and counted
      ++read.dropped;
      read.last_problem = error.what();
    }
  }
  read.unreadable_bytes = log.unreadable_bytes();
  return read;
}

ScannerSweeps FromLog(const std::string& path) {
  const ScannerLog log = ReadLog(path);
  if (!log.rig) throw InputError(path + ": no RIG in this log; record that channel, too");
  const TurnedScanner& scanner = ScannerOf(*log.rig, path);
  EncoderTrack track;
  for (const EncoderReading& reading : log.readings) track.Add(OnTime(scanner, reading));
  std::map<Utime, TurnedBeams> sweeps;
  for (const LineScan& line : log.lines) {
    const Utime sweep = track.SweepAt(line.utime);
    const auto angles = BeamAngles(scanner, track, line, Assembler::kMaxGap);
    if (sweep != 0 && angles) AppendLine(line, *angles, &sweeps[sweep]);
  }
  ScannerSweeps read;
  read.rig = *log.rig;
  for (auto& [utime, beams] : sweeps) {
    read.names.push_back(std::to_string(utime));
    read.sweeps.push_back(std::move(beams));
  }
  if (log.dropped > 0) {
    read.problems.push_back(std::to_string(log.dropped) +
                            " messages dropped; the last: " + log.last_problem);
  }
  if (log.unreadable_bytes > 0) {
    read.problems.push_back(std::to_string(log.unreadable_bytes) +
                            " bytes belong to no whole message; was the logger killed?");
  }
  return read;
}

}  // namespace

ScannerSweeps ReadScannerSweeps(const std::string& dir_or_log) {
  const bool is_log = std::filesystem::is_regular_file(dir_or_log);
  ScannerSweeps read = is_log ? FromLog(dir_or_log) : FromSession(dir_or_log);
  if (!read.sweeps.empty()) return read;
  const std::string why = read.problems.empty()
                              ? is_log ? "no LINE_SCAN with an ENCODER beside it" : "no views"
                              : read.problems.front();
  throw InputError(dir_or_log + ": no sweep could be used: " + why);
}

}  // namespace rgbdt
