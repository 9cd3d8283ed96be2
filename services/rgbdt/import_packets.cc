#include <cstdio>
#include <filesystem>
#include <set>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/packets/bag_packets.h"
#include "services/packets/recording.h"
#include "services/rgbdt/folder_flags.h"
#include "services/rgbdt/packet_import.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

// Throws InputError where it holds no sweep.
void Print(const Recording& recording, const std::string& file) {
  std::printf("%s at UDP port %d: %lld packets, %lld sweeps", recording.sensor.c_str(),
              recording.sender.port, static_cast<long long>(recording.packets),
              static_cast<long long>(recording.sweeps));
  const double seconds = ToSeconds(recording.last - recording.first);
  if (recording.sweeps > 1 && seconds > 0) {
    std::printf(", %.3g Hz", static_cast<double>(recording.sweeps - 1) / seconds);
  }
  std::printf("\n");
  constexpr int kMostLines = 10;
  int lines = 0;
  for (const auto& [sender, count] : recording.others) {
    if (++lines > kMostLines) break;
    std::printf("left out: UDP port %d from %s, %lld datagrams\n", sender.port, sender.from.c_str(),
                static_cast<long long>(count));
  }
  if (!recording.lost.empty()) std::printf("lost: %s\n", recording.lost.c_str());
  if (recording.bad > 0) {
    std::printf("problem: %lld packets could not be read, the last: %s\n",
                static_cast<long long>(recording.bad), recording.last_problem.c_str());
  }
  if (!recording.cut_off.empty()) std::printf("problem: %s\n", recording.cut_off.c_str());
  if (recording.sweeps == 0) {
    throw InputError(file + ": holds no whole sweep; record for a second or longer");
  }
}

}  // namespace

int ImportPackets(const PacketsToImport& packets) {
  const RecordingOptions options{packets.metadata, packets.port};
  const Recording recording = packets.out.empty()
                                  ? ReadRecording(packets.file, options, [](const Cloud&) {})
                                  : WriteRecordingAsPcds(packets.file, options, packets.out);
  Print(recording, packets.file);
  if (packets.out.empty()) {
    std::printf("next: add --images, --lens, --board and --out, or --out alone for PCD files\n");
  } else {
    std::printf("wrote %lld PCD files to %s\nnext: rgbdt session --clouds %s --images ...\n",
                static_cast<long long>(recording.sweeps), packets.out.c_str(),
                ForShell(packets.out).c_str());
  }
  return EndsWith(true);
}

int ImportPacketsAsSession(const PacketsToImport& packets, Folders folders) {
  const std::filesystem::path dir = std::filesystem::path(packets.out) / "clouds";
  if (std::filesystem::exists(dir)) {
    throw InputError(dir.string() + " is there already; remove it or name another --out");
  }
  const RecordingOptions options{packets.metadata, packets.port};
  Folders::Lidar lidar{"", dir};
  Print(
      ReadRecording(packets.file, options,
                    [&](const Cloud& sweep) { lidar.names.push_back(PcdName(sweep.sweep_utime)); }),
      packets.file);
  lidar.make = [&](const std::vector<std::string>& names) {
    const std::set<std::string> wanted(names.begin(), names.end());
    ReadRecording(packets.file, options, [&](const Cloud& sweep) {
      const std::string name = PcdName(sweep.sweep_utime);
      if (wanted.count(name) != 0) WritePcd(dir / name, sweep);
    });
  };
  folders.lidars = {lidar};
  try {
    return MakeSession(folders, packets.out);
  } catch (...) {
    std::error_code ignored;
    if (!std::filesystem::exists(dir.parent_path() / "rig.textproto", ignored)) {
      std::filesystem::remove_all(dir, ignored);
    }
    throw;
  }
}

CloudReader ReadPacketsInBag(const PacketsInBag& packets) {
  BagPacketsOptions options;
  options.topic = packets.topic->topic.name;
  const BagSurvey::Topic* told = MetadataOf(*packets.survey, *packets.topic);
  if (!packets.metadata.empty()) {
    options.metadata = ReadWholeFile(packets.metadata);
    options.metadata_name = packets.metadata;
  } else if (told != nullptr) {
    options.metadata = told->text;
    options.metadata_name = told->topic.name;
  }
  const auto reader = std::make_shared<BagPackets>(packets.bag, options);
  packets.topic->stamped = reader->Find(Tenths("decoding " + options.topic));
  for (const std::string& line : reader->lines()) std::printf("%s\n", line.c_str());
  return [reader](const Stamped& stamped) { return reader->Read(stamped); };
}

}  // namespace rgbdt
