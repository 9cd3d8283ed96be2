#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/model/time.h"
#include "services/messages/bytes.h"

namespace rgbdt {

/// Writes a log as lcm-logger does, by LCM's own event log. It has its name once it is closed, and
/// lies beside until then, as NAME.part; one that is never closed is gone with its owner.
class LogWriter {
 public:
  /// The folder is made. The log will take the place of a file, link, pipe or socket that is called
  /// so. Throws InputError where the file cannot be made, or a folder or device is called so.
  explicit LogWriter(const std::string& path);
  ~LogWriter();

  /// `receive_utime`: the wall clock, as LogEvent has it. Throws InputError where it cannot be
  /// written.
  void Write(const std::string& channel, const std::uint8_t* data, std::size_t size,
             Utime receive_utime);
  void Write(const std::string& channel, const Bytes& bytes, Utime receive_utime) {
    Write(channel, bytes.data(), bytes.size(), receive_utime);
  }

  /// All of it is on disk under its name, or InputError.
  void Close();
  /// It is not wanted after all.
  void Discard();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt
