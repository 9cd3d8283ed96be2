#include <lcm/lcm.h>
#include <poll.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/bus/multicast.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kMaxDelivery = std::chrono::milliseconds(100);

// LCM's queues count messages, not bytes, and a full one drops the newest. While a node computes,
// these wait: 64 images are 16 s of the demo's two cameras and 192 MB at worst; 4096 of anything
// else are 40 s of scan lines (13 MB), and more clouds than a sensor sends in minutes.
constexpr int kImageQueue = 64;
// Who hears everything has a few seconds of all of it, images among them.
constexpr int kQueue = 4096;
constexpr int kEverythingQueue = 512;

int QueueFor(const std::string& channel_regex) {
  if (channel_regex == ".*") return kEverythingQueue;
  return channel_regex.find("IMAGE") != std::string::npos ? kImageQueue : kQueue;
}

}  // namespace

std::string CompleteUrl(const std::string& url) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  std::string complete = url;
  if (complete.empty() && environment != nullptr) complete = environment;
  if (complete.empty()) complete = "udpm://239.255.76.67:7667?ttl=0";
  const bool udpm = complete.compare(0, 7, "udpm://") == 0;
  if (!udpm || complete.find("recv_buf_size=") != std::string::npos) return complete;
  const char* separator = complete.find('?') == std::string::npos ? "?" : "&";
  return complete + separator + "recv_buf_size=" + std::to_string(kReceiveBufferBytes);
}

struct LcmBus::Impl {
  struct Subscriber {
    Impl* bus;
    Handler handler;
  };

  // Called by C code, which an exception must not meet: it would abort the next lcm_handle().
  static void OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
    auto* subscriber = static_cast<Subscriber*>(user);
    try {
      subscriber->handler(channel, static_cast<const std::uint8_t*>(buffer->data),
                          buffer->data_size);
    } catch (...) {
      ++subscriber->bus->handler_failures;
    }
  }

  bool Readable(int timeout_ms) const {
    pollfd descriptor{lcm_get_fileno(lcm), POLLIN, 0};
    return poll(&descriptor, 1, timeout_ms) > 0;
  }

  lcm_t* lcm = nullptr;
  std::string url;
  bool ended = false;
  std::int64_t handler_failures = 0;
  std::vector<std::unique_ptr<Subscriber>> subscribers;
};

LcmBus::LcmBus(const std::string& url) : impl_(std::make_unique<Impl>()) {
  impl_->url = CompleteUrl(url);
  impl_->lcm = lcm_create(impl_->url.c_str());
  // The descriptor exists once LCM's own test message has come back.
  if (impl_->lcm != nullptr && lcm_get_fileno(impl_->lcm) >= 0) return;
  if (impl_->lcm != nullptr) lcm_destroy(impl_->lcm);
  throw InputError("cannot open the bus " + impl_->url + ": " + WhyNoBus(impl_->url));
}

LcmBus::~LcmBus() { lcm_destroy(impl_->lcm); }

void LcmBus::Publish(const std::string& channel, const Bytes& bytes) {
  if (channel.size() > LCM_MAX_CHANNEL_NAME_LENGTH) {
    throw InputError("channel " + channel + " has more than 63 characters");
  }
  errno = 0;
  if (lcm_publish(impl_->lcm, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) !=
      0) {
    throw InputError("cannot publish " + std::to_string(bytes.size()) + " bytes on " + impl_->url +
                     ": " + (errno != 0 ? std::strerror(errno) : "LCM refuses"));
  }
}

void LcmBus::Subscribe(const std::string& channel_regex, Handler handler) {
  auto subscriber = std::make_unique<Impl::Subscriber>();
  subscriber->bus = impl_.get();
  subscriber->handler = std::move(handler);
  // LCM puts ^ and $ around what it gets, so "A|B" alone would hear "A2" and "2B".
  lcm_subscription_t* subscription = lcm_subscribe(
      impl_->lcm, ("(?:" + channel_regex + ")").c_str(), &Impl::OnMessage, subscriber.get());
  if (subscription == nullptr) {
    throw InputError("\"" + channel_regex + "\" is no regular expression");
  }
  lcm_subscription_set_queue_capacity(subscription, QueueFor(channel_regex));
  impl_->subscribers.push_back(std::move(subscriber));
}

bool LcmBus::Run(int timeout_ms) {
  if (impl_->ended || !impl_->Readable(timeout_ms)) return false;
  const Clock::time_point end = Clock::now() + kMaxDelivery;
  do {
    if (lcm_handle(impl_->lcm) != 0) impl_->ended = true;
  } while (!impl_->ended && Clock::now() < end && impl_->Readable(0));
  return true;
}

bool LcmBus::ended() const { return impl_->ended; }

std::int64_t LcmBus::handler_failures() const { return impl_->handler_failures; }

}  // namespace rgbdt
