#include <deque>
#include <map>
#include <regex>

#include "calib/model/errors.h"
#include "services/bus/bus.h"

namespace rgbdt {

struct MemoryBus::Impl {
  struct Subscriber {
    std::regex regex;
    Handler handler;
  };
  struct Waiting {
    std::string channel;
    Bytes bytes;
    std::size_t subscribers;  // how many there were when it was published
  };

  // Which subscribers hear a channel; regular expressions are slow, channels few.
  const std::vector<std::size_t>& Hearing(const std::string& channel) {
    const auto [entry, is_new] = hearing.try_emplace(channel);
    if (is_new) {
      for (std::size_t i = 0; i < subscribers.size(); ++i) {
        if (std::regex_match(channel, subscribers[i].regex)) entry->second.push_back(i);
      }
    }
    return entry->second;
  }

  std::deque<Subscriber> subscribers;  // a handler may subscribe: addresses must stay
  std::map<std::string, std::vector<std::size_t>> hearing;
  std::deque<Waiting> waiting;
};

MemoryBus::MemoryBus() : impl_(std::make_unique<Impl>()) {}

MemoryBus::~MemoryBus() = default;

void MemoryBus::Publish(const std::string& channel, const Bytes& bytes) {
  if (impl_->Hearing(channel).empty()) return;
  impl_->waiting.push_back({channel, bytes, impl_->subscribers.size()});
}

void MemoryBus::Subscribe(const std::string& channel_regex, Handler handler) {
  try {
    impl_->subscribers.push_back({std::regex(channel_regex), std::move(handler)});
  } catch (const std::regex_error& e) {
    throw InputError("\"" + channel_regex + "\" is no regular expression: " + e.what());
  }
  impl_->hearing.clear();
}

void MemoryBus::Run() {
  while (!impl_->waiting.empty()) {
    const Impl::Waiting message = std::move(impl_->waiting.front());
    impl_->waiting.pop_front();
    const std::vector<std::size_t> hearing = impl_->Hearing(message.channel);
    for (const std::size_t i : hearing) {
      if (i >= message.subscribers) break;
      impl_->subscribers[i].handler(message.channel, message.bytes.data(), message.bytes.size());
    }
  }
}

}  // namespace rgbdt
