#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "calib/model/errors.h"
#include "services/bus/log.h"

namespace rgbdt {
namespace {

// An event of an LCM log, big-endian: sync word, event number (8), time (8), channel's length (4),
// data's length (4), channel, data. (lcm/eventlog.c)
constexpr std::uint32_t kLogSync = 0xEDA1DA01;
constexpr std::int64_t kLogHeaderBytes = 28;
constexpr std::int64_t kLogMaxChannelBytes = 255;   // LCM itself: 63
constexpr std::int64_t kLogMaxDataBytes = 1 << 28;  // LCM_MAX_MESSAGE_SIZE

struct Header {
  std::int64_t number;
  Utime utime;
  std::int64_t channel_bytes;
  std::int64_t data_bytes;

  std::int64_t EventBytes() const { return kLogHeaderBytes + channel_bytes + data_bytes; }
};

std::int64_t BigEndian(const std::uint8_t* p, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | p[i];
  return bytes == 4 ? static_cast<std::int32_t>(value) : static_cast<std::int64_t>(value);
}

bool IsSync(const std::uint8_t* p) {
  return BigEndian(p, 4) == static_cast<std::int32_t>(kLogSync);
}

// Where the first sync word stands; `size` if there is none.
std::size_t FindSync(const std::uint8_t* data, std::size_t size) {
  for (std::size_t i = 0; i + 4 <= size; ++i) {
    const void* first = std::memchr(data + i, kLogSync >> 24, size - i - 3);
    if (first == nullptr) return size;
    i = static_cast<std::size_t>(static_cast<const std::uint8_t*>(first) - data);
    if (IsSync(data + i)) return i;
  }
  return size;
}

}  // namespace

struct LogReader::Impl {
  ~Impl() {
    if (descriptor >= 0) close(descriptor);
  }

  // At most `bytes` from `from`; fewer at the end of the file.
  std::size_t Read(std::int64_t from, void* to, std::size_t bytes) const {
    std::size_t done = 0;
    while (done < bytes) {
      const ssize_t got = pread(descriptor, static_cast<char*>(to) + done, bytes - done,
                                from + static_cast<std::int64_t>(done));
      if (got < 0) ThrowErrno();
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }

  [[noreturn]] void ThrowErrno() const {
    throw InputError("cannot read " + path + ": " + std::strerror(errno));
  }

  // The header at `from`, if lengths are plausible and the whole event lies within the file.
  std::optional<Header> HeaderAt(std::int64_t from) const {
    std::array<std::uint8_t, kLogHeaderBytes> p;
    if (Read(from, p.data(), p.size()) < p.size() || !IsSync(p.data())) return std::nullopt;
    const Header header{BigEndian(&p[4], 8), BigEndian(&p[12], 8), BigEndian(&p[20], 4),
                        BigEndian(&p[24], 4)};
    const bool good = header.channel_bytes > 0 && header.channel_bytes <= kLogMaxChannelBytes &&
                      header.data_bytes >= 0 && header.data_bytes <= kLogMaxDataBytes &&
                      from + header.EventBytes() <= size;
    return good ? std::optional<Header>(header) : std::nullopt;
  }

  bool EndsWell(std::int64_t end) const {
    std::array<std::uint8_t, 4> next;
    return end == size || (Read(end, next.data(), 4) == 4 && IsSync(next.data()));
  }

  // Where the next sync word after `from` stands, or the end of the file.
  std::int64_t NextSync(std::int64_t from) const {
    std::vector<std::uint8_t> block(1 << 10);
    for (++from; from + 4 <= size;) {
      const std::size_t got = Read(from, block.data(), block.size());
      const std::size_t found = FindSync(block.data(), got);
      if (found < got) return from + static_cast<std::int64_t>(found);
      if (got < block.size()) break;
      from += static_cast<std::int64_t>(got) - 3;  // a sync word may lie across
      block.resize(std::min<std::size_t>(4 * block.size(), 1 << 20));
    }
    return size;
  }

  // Where rubbish follows an event, either it is rubbish or the event's length is: in the second
  // case the event has swallowed others, and the first of them is where to go on.
  std::optional<std::int64_t> SwallowedEvent(std::int64_t end) const {
    if (EndsWell(end)) return std::nullopt;
    const std::int64_t sync = NextSync(at);
    return sync < end && HeaderAt(sync) ? std::optional<std::int64_t>(sync) : std::nullopt;
  }

  LogEvent ReadEvent(const Header& header) const {
    LogEvent event;
    event.number = header.number;
    event.receive_utime = header.utime;
    event.channel.resize(static_cast<std::size_t>(header.channel_bytes));
    event.bytes.resize(static_cast<std::size_t>(header.data_bytes));
    const std::int64_t channel_at = at + kLogHeaderBytes;
    Read(channel_at, event.channel.data(), event.channel.size());
    Read(channel_at + header.channel_bytes, event.bytes.data(), event.bytes.size());
    return event;
  }

  void SkipTo(std::int64_t to) {
    unreadable += to - at;
    at = to;
  }

  std::string path;
  int descriptor = -1;
  std::int64_t size = 0;
  std::int64_t at = 0;  // of the next event
  std::int64_t unreadable = 0;
};

LogReader::LogReader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (impl_->descriptor < 0 || fstat(impl_->descriptor, &status) != 0) impl_->ThrowErrno();
  if (!S_ISREG(status.st_mode)) {  // a pipe would be waited for
    throw InputError("cannot read " + path + ": it is no regular file; expected an LCM log");
  }
  impl_->size = status.st_size;
  if (impl_->size > 0 && !impl_->HeaderAt(0) && impl_->NextSync(0) == impl_->size) {
    throw InputError(path + " is no LCM log: it has " + std::to_string(impl_->size) +
                     " bytes and no event");
  }
}

LogReader::~LogReader() = default;

std::optional<LogEvent> LogReader::Next() {
  Impl& log = *impl_;
  while (log.at < log.size) {
    const std::optional<Header> header = log.HeaderAt(log.at);
    if (!header) {
      log.SkipTo(log.NextSync(log.at));
      continue;
    }
    const std::int64_t end = log.at + header->EventBytes();
    if (const auto swallowed = log.SwallowedEvent(end)) {
      log.SkipTo(*swallowed);
      continue;
    }
    LogEvent event = log.ReadEvent(*header);
    log.at = end;
    return event;
  }
  return std::nullopt;
}

std::int64_t LogReader::unreadable_bytes() const { return impl_->unreadable; }
std::int64_t LogReader::position() const { return impl_->at; }
std::int64_t LogReader::size() const { return impl_->size; }

}  // namespace rgbdt
