#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "calib/model/cloud.h"

namespace rgbdt {

struct RecordingOptions {
  std::filesystem::path
      metadata;  ///< an Ouster's JSON, a Hesai's or RoboSense's angles (CSV); empty: none needed
  int port = 0;  ///< that the LIDAR sends to; 0: where its packets are most
};

/// Who sent datagrams, and where to.
struct Sender {
  int port = 0;      ///< that they went to
  std::string from;  ///< address
  bool operator<(const Sender& other) const {
    return std::tie(port, from) < std::tie(other.port, other.from);
  }
};

/// What a recording of a LIDAR's packets holds.
struct Recording {
  std::string sensor;        ///< "OS-1-64"
  Sender sender;             ///< that sent most of its packets: of several LIDARs, one
  std::int64_t packets = 0;  ///< of the LIDAR
  std::int64_t bad = 0;      ///< of these, could not be decoded, or the recording has not all of it
  std::string last_problem;
  std::map<Sender, std::int64_t> others;  ///< datagrams that are left out
  std::int64_t sweeps = 0;
  Utime first = 0, last = 0;  ///< of the sweeps
  std::string lost;           ///< in words; empty: nothing
  std::string cut_off;        ///< where and why the recording ends too early; empty: it does not
};

/// Reads it, front to back, twice; `take` gets each whole sweep. Memory does not grow with it.
/// Throws InputError: no recording, no packets of a known LIDAR in it, metadata that cannot be
/// read, and what `take` throws.
Recording ReadRecording(const std::filesystem::path& path, const RecordingOptions& options,
                        const std::function<void(const Cloud&)>& take);

/// What a sweep's file is called, by its time: SECONDS.MICROSECONDS.pcd.
std::string PcdName(Utime sweep_utime);

/// The sweeps as PCD files into `dir`, which is new or empty, named by their times as `rgbdt
/// session
/// --clouds` pairs them with images: SECONDS.MICROSECONDS.pcd.
Recording WriteRecordingAsPcds(const std::filesystem::path& path, const RecordingOptions& options,
                               const std::filesystem::path& dir);

}  // namespace rgbdt
