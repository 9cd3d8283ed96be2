#include "services/bus/log_writer.h"

#include <lcm/eventlog.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// What lies there is not written through: it may be a stranger's link, or a pipe. A folder stays,
// and so do devices: as root /dev/null would be gone.
lcm_eventlog_t* CreateAnew(const std::string& path) {
  using Type = std::filesystem::file_type;
  std::error_code error;
  switch (std::filesystem::symlink_status(path, error).type()) {
    case Type::regular:
    case Type::symlink:
    case Type::fifo:
    case Type::socket:
      std::filesystem::remove(path, error);
      if (error) throw InputError("cannot remove " + path + ": " + error.message());
      break;
    case Type::block:
    case Type::character:
      throw InputError(path + " is a device; a log is written to a file: name another");
    default:  // nothing, or what LCM cannot open
      break;
  }
  return lcm_eventlog_create(path.c_str(), "w");
}

}  // namespace

struct LogWriter::Impl {
  struct Destroy {
    void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
  };

  explicit Impl(const std::string& at) : path(at), log(CreateAnew(at)) {
    if (log == nullptr) ThrowErrno();
  }

  [[noreturn]] void ThrowErrno() const {
    throw InputError("cannot write " + path + ": " + std::strerror(errno));
  }

  std::string path;
  std::unique_ptr<lcm_eventlog_t, Destroy> log;
};

LogWriter::LogWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
LogWriter::~LogWriter() = default;

void LogWriter::Write(const std::string& channel, const std::uint8_t* data, std::size_t size,
                      Utime receive_utime) {
  lcm_eventlog_event_t event{};
  event.timestamp = receive_utime;
  event.channellen = static_cast<std::int32_t>(channel.size());
  event.datalen = static_cast<std::int32_t>(size);
  event.channel = const_cast<char*>(channel.data());  // LCM only reads them
  event.data = const_cast<std::uint8_t*>(data);
  if (lcm_eventlog_write_event(impl_->log.get(), &event) != 0) impl_->ThrowErrno();
}

void LogWriter::Close() {
  if (std::fflush(impl_->log->f) != 0) impl_->ThrowErrno();
  impl_->log.reset();
}

}  // namespace rgbdt
