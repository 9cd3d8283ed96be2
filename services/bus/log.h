#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "calib/model/time.h"
#include "services/bus/bus.h"

namespace rgbdt {

/// One message as lcm-logger wrote it.
struct LogEvent {
  std::int64_t number = 0;
  Utime receive_utime = 0;  ///< the logger's wall clock: never data; data has its own `utime`
  std::string channel;
  Bytes bytes;
};

/// Reads an LCM log in order. LCM's own reader ends at the first thing that it does not like and
/// allocates what a length says; this one goes on at the next event that makes sense and counts
/// the bytes between. A log cut short (a full disk, a killed logger) so gives all its whole events.
class LogReader {
 public:
  /// Throws InputError where there is no such file, or nothing in it looks like an LCM log.
  explicit LogReader(const std::string& path);
  ~LogReader();

  /// The next event; nothing at the end. Throws InputError where the disk fails.
  std::optional<LogEvent> Next();

  /// So far: bytes that belong to no whole event.
  std::int64_t unreadable_bytes() const;
  /// How far, of how much: for progress.
  std::int64_t position() const;
  std::int64_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt
