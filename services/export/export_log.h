#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "services/foxglove/stream/foxglove_stream.h"

namespace rgbdt {

/// What came of a log.
struct ExportedLog {
  struct Topic {
    std::string schema;  ///< "foxglove.PointCloud"
    std::int64_t messages = 0;
  };
  std::map<std::string, Topic> topics;           ///< by name
  std::map<std::string, std::int64_t> left_out;  ///< channels without a counterpart, and how many
  std::int64_t torn_sweeps = 0;                  ///< of which lines or the end never came
  std::int64_t dropped = 0;                      ///< messages that could not be used
  std::string last_problem;
  std::int64_t unreadable_bytes = 0;  ///< of the log
};

/// An LCM log as an MCAP of Foxglove's messages (Protobuf), which viewers open without a plug-in;
/// its topics: foxglove_stream.h.
///
/// The times of the file are the sensors': a message is logged at the newest sensor time so far, so
/// the same log gives the same bytes. The log is read twice. Memory does not grow with it: a sweep
/// at a time. `out` is written whole or not at all. `progress`: how far, 0 to 1. Throws InputError:
/// no such log, nothing in it to export, a disk that fails.
ExportedLog ExportLog(const std::string& log, const std::filesystem::path& out,
                      const FoxgloveFrames& frames = {},
                      const std::function<void(double)>& progress = {});

}  // namespace rgbdt
