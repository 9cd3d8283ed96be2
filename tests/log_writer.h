#pragma once

#include <lcm/eventlog.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/time.h"
#include "services/messages/bytes.h"

namespace rgbdt::test {

/// Writes an LCM log through LCM's own event log.
class LogWriter {
 public:
  /// Throws InputError where the file cannot be made.
  explicit LogWriter(std::string path)
      : path_(std::move(path)), log_(lcm_eventlog_create(path_.c_str(), "w")) {
    if (log_ == nullptr) ThrowErrno();
  }

  /// Throws InputError where it cannot be written.
  void Write(const std::string& channel, const Bytes& bytes, Utime receive_utime) {
    lcm_eventlog_event_t event{};
    event.timestamp = receive_utime;
    event.channellen = static_cast<std::int32_t>(channel.size());
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.channel = const_cast<char*>(channel.data());  // LCM only reads it
    event.data = const_cast<std::uint8_t*>(bytes.data());
    if (lcm_eventlog_write_event(log_.get(), &event) != 0) ThrowErrno();
  }

  /// All of it is on the disk, or InputError. The destructor closes without a word.
  void Close() {
    if (std::fflush(log_->f) != 0) ThrowErrno();
    log_.reset();
  }

 private:
  struct Destroy {
    void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
  };

  [[noreturn]] void ThrowErrno() const {
    throw InputError("cannot write " + path_ + ": " + std::strerror(errno));
  }

  std::string path_;
  std::unique_ptr<lcm_eventlog_t, Destroy> log_;
};

}  // namespace rgbdt::test
