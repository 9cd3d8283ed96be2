#include <lcm/lcm.h>
#include <poll.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/bus/internal/datagram.h"
#include "services/bus/internal/source.h"
#include "services/bus/internal/udp_sender.h"
#include "services/bus/multicast.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kMaxDelivery = std::chrono::milliseconds(100);

// While a node computes, these wait: 64 images are 16 s of the demo's two cameras and 192 MB at
// worst; 4096 of anything else are 40 s of scan lines (13 MB), and more clouds than a sensor sends
// in minutes. All that wait have 256 MiB at most (Inbox), however large each is.
constexpr std::size_t kImageQueue = 64;
// Who hears everything has a few seconds of all of it, images among them.
constexpr std::size_t kQueue = 4096;
constexpr std::size_t kEverythingQueue = 512;
// Of who wants the newest: some 0.2 s of what a large rig sends, images less than clouds, which a
// fuser handles in 0.1 s; and seconds of a turned scanner's lines, as a long sweep's end takes
// long.
constexpr std::size_t kNewestImages = std::size_t{20} << 20, kNewestClouds = std::size_t{8} << 20;

Room RoomFor(const std::string& channel_regex, bool wants_newest) {
  if (channel_regex == ".*") return {kEverythingQueue};
  const bool images = channel_regex.find("IMAGE") != std::string::npos;
  const std::size_t newest = images ? kNewestImages : channel_regex == "CLOUD" ? kNewestClouds : 0;
  return {images ? kImageQueue : kQueue, wants_newest ? newest : 0};
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
  ~Impl() {
    source.reset();
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  void OpenSource() {
    if (lcm == nullptr) return;
    if (url.compare(0, 7, "udpm://") != 0) {
      source = MakeLcmSource(lcm);
      return;
    }
    const BusUrl parsed = ParseBusUrl(url);
    if (!parsed.error.empty()) throw InputError(parsed.error);
    if (parsed.ttl > 0) sender = std::make_unique<UdpSender>(parsed);
    const auto send_test = [this] {
      const std::string test = "lcm self test";
      Publish(kSelfTestChannel, {test.begin(), test.end()});
    };
    source = MakeUdpSource(parsed, send_test, sender.get());
  }

  void Publish(const std::string& channel, const Bytes& bytes) const {
    if (sender != nullptr) return sender->Publish(channel, bytes);
    errno = 0;
    if (lcm_publish(lcm, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
      throw InputError(errno != 0 ? std::strerror(errno) : "LCM refuses");
    }
  }

  bool Readable(int timeout_ms) const {
    pollfd descriptor{source->descriptor(), POLLIN, 0};
    return poll(&descriptor, 1, timeout_ms) > 0;
  }

  lcm_t* lcm = nullptr;
  std::unique_ptr<UdpSender> sender;  // where the bus leaves the machine; else LCM sends
  std::unique_ptr<Source> source;
  std::string url;
  bool ended = false;
  bool wants_newest = false;
  std::int64_t handler_failures = 0;
};

LcmBus::LcmBus(const std::string& url) : impl_(std::make_unique<Impl>()) {
  impl_->url = CompleteUrl(url);
  impl_->lcm = lcm_create(impl_->url.c_str());
  std::string why;
  try {
    impl_->OpenSource();
    if (impl_->source == nullptr) why = WhyNoBus(impl_->url);
  } catch (const InputError& e) {
    why = e.what();
  }
  if (!why.empty()) throw InputError("cannot open the bus " + impl_->url + ": " + why);
}

LcmBus::~LcmBus() = default;

void LcmBus::Publish(const std::string& channel, const Bytes& bytes) {
  if (channel.size() > kMaxChannelBytes) {
    throw InputError("channel " + channel + " has more than 63 characters");
  }
  try {
    impl_->Publish(channel, bytes);
  } catch (const InputError& e) {
    throw InputError("cannot publish " + std::to_string(bytes.size()) + " bytes on " + impl_->url +
                     ": " + e.what());
  }
}

void LcmBus::Subscribe(const std::string& channel_regex, Handler handler) {
  // Called by C code, too, which an exception must not meet: it would abort the next lcm_handle().
  const auto guarded = [bus = impl_.get(), handler = std::move(handler)](
                           const std::string& channel, const std::uint8_t* data, std::size_t size) {
    try {
      handler(channel, data, size);
    } catch (...) {
      ++bus->handler_failures;
    }
  };
  impl_->source->Subscribe(channel_regex, RoomFor(channel_regex, impl_->wants_newest), guarded);
}

void LcmBus::WantNewest() { impl_->wants_newest = true; }
bool LcmBus::waits() const { return impl_->Readable(0); }

Malformed LcmBus::malformed() const { return impl_->source->malformed(); }

LinkReport LcmBus::links() const { return impl_->source->links(); }
Utime LcmBus::arrived() const { return impl_->source->arrived(); }

bool LcmBus::Run(int timeout_ms) {
  if (impl_->ended || !impl_->Readable(timeout_ms)) return false;
  const Clock::time_point end = Clock::now() + kMaxDelivery;
  do {
    if (!impl_->source->Deliver()) impl_->ended = true;
  } while (!impl_->ended && Clock::now() < end && impl_->Readable(0));
  return true;
}

bool LcmBus::ended() const { return impl_->ended; }

std::int64_t LcmBus::handler_failures() const { return impl_->handler_failures; }

}  // namespace rgbdt
