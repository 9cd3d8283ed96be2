#include "services/bus/log_writer.h"

#include <lcm/eventlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// A folder stays, and so do devices: as root /dev/null would be gone.
void RequireNoDevice(const std::string& path) {
  std::error_code ignored;
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  const bool device = type == fs::file_type::block || type == fs::file_type::character;
  if (!device && type != fs::file_type::directory) return;
  throw InputError(path + " is a " + (device ? "device" : "folder") +
                   "; a log is written to a file: name another");
}

// What lies there is not written through: it may be a stranger's link, or a pipe.
lcm_eventlog_t* CreateAnew(const std::string& path) {
  RequireNoDevice(path);
  std::error_code error;
  fs::remove(path, error);
  if (error) throw InputError("cannot remove " + path + ": " + error.message());
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty()) fs::create_directories(folder, error);  // told where it cannot be opened
  return lcm_eventlog_create(path.c_str(), "w");
}

}  // namespace

struct LogWriter::Impl {
  struct Destroy {
    void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
  };

  explicit Impl(const std::string& at) : path(at), part(at + ".part") {
    RequireNoDevice(path);
    log.reset(CreateAnew(part));
    if (log == nullptr) ThrowErrno();
  }
  ~Impl() {
    if (log == nullptr) return;
    std::error_code ignored;
    fs::remove(part, ignored);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[noreturn]] void ThrowErrno() const {
    throw InputError("cannot write " + path + ": " + std::strerror(errno));
  }

  std::string path, part;
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
  std::FILE* file = impl_->log->f;
  if (std::fflush(file) != 0 || ::fsync(::fileno(file)) != 0) impl_->ThrowErrno();
  Rename(impl_->part, impl_->path);
  impl_->log.reset();
}

void LogWriter::Discard() { impl_.reset(); }

}  // namespace rgbdt
