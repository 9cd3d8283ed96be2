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

void Inbox::Add(WholeMessage message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::vector<Subscriber*>& hearing = Hearing(message.channel);
  const std::size_t size = message.bytes.size();
  if (hearing.empty() || !MakeRoom(size)) return Signal();
  Waiting waiting;
  for (Subscriber* subscriber : hearing) {
    if (MakeRoom(size, subscriber)) waiting.to.push_back(subscriber);
  }
  if (!waiting.to.empty()) {
    for (Subscriber* subscriber : waiting.to) {
      ++subscriber->waiting;
      subscriber->bytes += size;
    }
    bytes_ += size;
    images_ += IsImageChannel(message.channel) ? 1 : 0;
    waiting.message = std::move(message);
    waiting.arrived = HostUtime();
    waiting_.push_back(std::move(waiting));
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

// That waits for a subscriber.
Inbox::Queue::iterator Inbox::Oldest(const Subscriber& of, bool image) {
  if (of.waiting == 0 || (image && images_ == 0)) return waiting_.end();
  return std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
    const auto& to = waiting.to;
    return (!image || IsImageChannel(waiting.message.channel)) &&
           std::find(to.begin(), to.end(), &of) != to.end();
  });
}

// For one more in its queue.
bool Inbox::MakeRoom(std::size_t bytes, Subscriber* subscriber) {
  const Room& room = subscriber->room;
  const bool wants_newest = room.newest_bytes != 0;
  while (subscriber->waiting >= room.messages ||
         (wants_newest && subscriber->bytes + bytes > room.newest_bytes)) {
    const auto oldest = Oldest(*subscriber, !wants_newest);
    if (oldest == waiting_.end()) return subscriber->waiting < room.messages;
    LeaveOut(oldest, subscriber);
  }
  return true;
}

// For one more of all.
bool Inbox::MakeRoom(std::size_t bytes) {
  const std::size_t needed = bytes + (bytes > kSmall ? kForSmall : 0);
  if (needed > max_bytes_) return false;
  while (needed + bytes_ > max_bytes_ && images_ > 0) {
    Remove(std::find_if(waiting_.begin(), waiting_.end(), [](const Waiting& waiting) {
      return IsImageChannel(waiting.message.channel);
    }));
  }
  return needed + bytes_ <= max_bytes_;
}

// That a subscriber does not get.
void Inbox::LeaveOut(Queue::iterator waiting, Subscriber* subscriber) {
  auto& to = waiting->to;
  if (to.size() == 1) {
    Remove(waiting);
    return;
  }
  to.erase(std::find(to.begin(), to.end(), subscriber));
  --subscriber->waiting;
  subscriber->bytes -= waiting->message.bytes.size();
}

Inbox::Queue Inbox::Remove(Queue::iterator waiting) {
  const std::size_t size = waiting->message.bytes.size();
  for (Subscriber* subscriber : waiting->to) {
    --subscriber->waiting;
    subscriber->bytes -= size;
  }
  bytes_ -= size;
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

void Inbox::Subscribe(const std::string& channel_regex, const Room& room, Bus::Handler handler) {
  try {
    std::regex regex(channel_regex);
    const std::lock_guard<std::mutex> lock(mutex_);
    subscribers_.push_back({std::move(regex), room, std::move(handler)});
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
