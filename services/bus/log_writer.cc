#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "calib/model/errors.h"
#include "services/bus/internal/log_format.h"
#include "services/bus/log.h"

namespace rgbdt {
namespace {

void PutBigEndian(std::uint64_t value, int bytes, std::uint8_t* p) {
  for (int i = 0; i < bytes; ++i) p[i] = static_cast<std::uint8_t>(value >> (8 * (bytes - 1 - i)));
}

}  // namespace

struct LogWriter::Impl {
  ~Impl() {
    if (file != nullptr) std::fclose(file);
  }

  [[noreturn]] void ThrowErrno() const {
    throw InputError("cannot write " + path + ": " + std::strerror(errno));
  }

  void Put(const void* data, std::size_t size) {
    if (size > 0 && std::fwrite(data, 1, size, file) != size) ThrowErrno();
  }

  std::string path;
  std::FILE* file = nullptr;
  std::uint64_t events = 0;
};

LogWriter::LogWriter(const std::string& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->file = std::fopen(path.c_str(), "wb");
  if (impl_->file == nullptr) impl_->ThrowErrno();
}

LogWriter::~LogWriter() = default;

void LogWriter::Write(const std::string& channel, const Bytes& bytes, Utime receive_utime) {
  if (impl_->file == nullptr) throw InputError(impl_->path + " is closed already");
  if (channel.empty() || static_cast<std::int64_t>(channel.size()) > kLogMaxChannelBytes) {
    throw InputError("a channel's name has " + std::to_string(channel.size()) +
                     " characters; expected 1 to " + std::to_string(kLogMaxChannelBytes));
  }
  std::array<std::uint8_t, kLogHeaderBytes> header;
  PutBigEndian(kLogSync, 4, &header[0]);
  PutBigEndian(impl_->events++, 8, &header[4]);
  PutBigEndian(static_cast<std::uint64_t>(receive_utime), 8, &header[12]);
  PutBigEndian(channel.size(), 4, &header[20]);
  PutBigEndian(bytes.size(), 4, &header[24]);
  impl_->Put(header.data(), header.size());
  impl_->Put(channel.data(), channel.size());
  impl_->Put(bytes.data(), bytes.size());
}

void LogWriter::Close() {
  if (impl_->file == nullptr) return;
  const int result = std::fclose(impl_->file);
  impl_->file = nullptr;
  if (result != 0) impl_->ThrowErrno();
}

}  // namespace rgbdt
