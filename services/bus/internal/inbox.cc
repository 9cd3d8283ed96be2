#include "services/bus/internal/inbox.h"

#include <sys/eventfd.h>

#include "calib/model/errors.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

// Names come from strangers, too: forget them all rather than grow.
constexpr std::size_t kMaxChannels = 1000;

}  // namespace

Inbox::Inbox(std::size_t max_bytes)
    : waits_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), max_bytes_(max_bytes) {
  if (!waits_) throw InputError("no descriptor for the bus: too many files are open");
}

// Which subscribers hear a channel; regular expressions are slow, channels few.
const std::vector<Inbox::Subscriber*>& Inbox::Hearing(const std::string& channel) {
  if (hearing_.size() >= kMaxChannels && hearing_.count(channel) == 0) hearing_.clear();
  const auto [entry, is_new] = hearing_.try_emplace(channel);
  if (is_new) {
    for (Subscriber& subscriber : subscribers_) {
      if (std::regex_match(channel, subscriber.regex)) entry->second.push_back(&subscriber);
    }
  }
  return entry->second;
}

bool Inbox::IsWanted(const std::string& channel) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !Hearing(channel).empty();
}

void Inbox::Add(WholeMessage message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::size_t size = message.bytes.size();
  if (size + bytes_ + (size > kSmall ? kForSmall : 0) > max_bytes_) return;
  Waiting waiting;
  for (Subscriber* subscriber : Hearing(message.channel)) {
    if (subscriber->waiting < subscriber->capacity) waiting.to.push_back(subscriber);
  }
  if (waiting.to.empty()) return;
  for (Subscriber* subscriber : waiting.to) ++subscriber->waiting;
  bytes_ += size;
  waiting.message = std::move(message);
  waiting.arrived = HostUtime();
  waiting_.push_back(std::move(waiting));
  if (waiting_.size() == 1) eventfd_write(waits_.get(), 1);
}

void Inbox::AddMalformed(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++malformed_.count;
  malformed_.newest = what;
}

Malformed Inbox::malformed() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return malformed_;
}

void Inbox::Subscribe(const std::string& channel_regex, std::size_t capacity,
                      Bus::Handler handler) {
  try {
    std::regex regex(channel_regex);
    const std::lock_guard<std::mutex> lock(mutex_);
    subscribers_.push_back({std::move(regex), capacity, std::move(handler), 0});
    hearing_.clear();
  } catch (const std::regex_error& e) {
    throw InputError("\"" + channel_regex + "\" is no regular expression: " + e.what());
  }
}

void Inbox::DeliverOne() {
  Waiting next;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.empty()) return;
    next = std::move(waiting_.front());
    waiting_.pop_front();
    bytes_ -= next.message.bytes.size();
    for (Subscriber* subscriber : next.to) --subscriber->waiting;
    eventfd_t count = 0;
    if (waiting_.empty()) eventfd_read(waits_.get(), &count);
  }
  arrived_ = next.arrived;
  for (const Subscriber* subscriber : next.to) {
    subscriber->handler(next.message.channel, next.message.bytes.data(), next.message.bytes.size());
  }
}

}  // namespace rgbdt
