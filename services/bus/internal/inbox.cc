#include "services/bus/internal/inbox.h"

#include <sys/eventfd.h>

#include <algorithm>

#include "calib/model/errors.h"
#include "services/messages/image_channel.h"
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

void Inbox::Add(WholeMessage message, Utime came) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::vector<Subscriber*>& hearing = Hearing(message.channel);
  if (hearing.empty()) return;
  for (Subscriber* subscriber : hearing) LeaveOutStale(message.channel, subscriber, came);
  const std::size_t size = message.bytes.size();
  if (MakeRoom(size)) {
    Waiting waiting;
    for (Subscriber* subscriber : hearing) {
      if (MakeRoom(subscriber)) waiting.to.push_back(subscriber);
    }
    if (!waiting.to.empty()) {
      for (Subscriber* subscriber : waiting.to) ++subscriber->waiting;
      bytes_ += size;
      images_ += IsImageChannel(message.channel) ? 1 : 0;
      waiting.message = std::move(message);
      waiting.arrived = HostUtime();
      waiting.came = came;
      waiting_.push_back(std::move(waiting));
    }
  }
  Signal();
}

// The descriptor is readable while a message waits.
void Inbox::Signal() {
  if (signalled_ == !waiting_.empty()) return;
  signalled_ = !waiting_.empty();
  eventfd_t count = 0;
  if (signalled_) {
    eventfd_write(waits_.get(), 1);
  } else {
    eventfd_read(waits_.get(), &count);
  }
}

// That waits for a subscriber, or for anybody.
Inbox::Queue::iterator Inbox::OldestImage(const Subscriber* of) {
  if (images_ == 0) return waiting_.end();
  return std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
    const auto& to = waiting.to;
    return IsImageChannel(waiting.message.channel) &&
           (of == nullptr || std::find(to.begin(), to.end(), of) != to.end());
  });
}

// For one more in its queue.
bool Inbox::MakeRoom(Subscriber* subscriber) {
  if (subscriber->waiting < subscriber->capacity) return true;
  const auto image = OldestImage(subscriber);
  if (image == waiting_.end()) return false;
  LeaveOut(image, subscriber);
  return true;
}

bool Inbox::MakeRoom(std::size_t bytes) {
  const std::size_t needed = bytes + (bytes > kSmall ? kForSmall : 0);
  if (needed > max_bytes_) return false;
  while (needed + bytes_ > max_bytes_) {
    const auto image = OldestImage(nullptr);
    if (image == waiting_.end()) return false;
    const std::vector<Subscriber*> to = image->to;
    for (Subscriber* subscriber : to) LeaveOut(image, subscriber);
  }
  return true;
}

void Inbox::LeaveOutStale(const std::string& channel, Subscriber* subscriber, Utime now) {
  if (subscriber->stale == 0) return;
  auto waiting = waiting_.begin();
  while (waiting != waiting_.end() && waiting->came < now - subscriber->stale) {
    waiting =
        waiting->message.channel == channel ? LeaveOut(waiting, subscriber) : std::next(waiting);
  }
}

// One that a subscriber does not get; the next one.
Inbox::Queue::iterator Inbox::LeaveOut(Queue::iterator waiting, Subscriber* subscriber) {
  auto& to = waiting->to;
  const auto found = std::find(to.begin(), to.end(), subscriber);
  if (found == to.end()) return std::next(waiting);
  to.erase(found);
  --subscriber->waiting;
  const auto next = std::next(waiting);
  if (to.empty()) Remove(waiting);
  return next;
}

Inbox::Queue Inbox::Remove(Queue::iterator waiting) {
  bytes_ -= waiting->message.bytes.size();
  images_ -= IsImageChannel(waiting->message.channel) ? 1 : 0;
  Queue removed;
  removed.splice(removed.end(), waiting_, waiting);
  return removed;
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

void Inbox::Subscribe(const std::string& channel_regex, std::size_t capacity, Utime stale,
                      Bus::Handler handler) {
  try {
    std::regex regex(channel_regex);
    const std::lock_guard<std::mutex> lock(mutex_);
    subscribers_.push_back({std::move(regex), capacity, stale, std::move(handler)});
    hearing_.clear();
  } catch (const std::regex_error& e) {
    throw InputError("\"" + channel_regex + "\" is no regular expression: " + e.what());
  }
}

void Inbox::DeliverOne() {
  Queue next;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.empty()) return;
    for (Subscriber* subscriber : waiting_.front().to) --subscriber->waiting;
    next = Remove(waiting_.begin());
    Signal();
  }
  const Waiting& one = next.front();
  arrived_ = one.arrived;
  for (const Subscriber* subscriber : one.to) {
    subscriber->handler(one.message.channel, one.message.bytes.data(), one.message.bytes.size());
  }
}

}  // namespace rgbdt
