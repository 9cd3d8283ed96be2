#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/model/time.h"
#include "services/messages/bytes.h"

namespace rgbdt {

/// Writes a log as lcm-logger does, by LCM's own event log.
class LogWriter {
 public:
  /// It takes the place of a file, link, pipe or socket that is called so. Throws InputError where
  /// the file cannot be made, or a device is called so.
  explicit LogWriter(const std::string& path);
  ~LogWriter();

  /// `receive_utime`: the wall clock, as LogEvent has it. Throws InputError where it cannot be
  /// written.
  void Write(const std::string& channel, const std::uint8_t* data, std::size_t size,
             Utime receive_utime);
  void Write(const std::string& channel, const Bytes& bytes, Utime receive_utime) {
    Write(channel, bytes.data(), bytes.size(), receive_utime);
  }

  /// All of it is handed to the system, or InputError. The destructor closes without a word.
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt
