#include "viewer/live/bus_monitor.h"

#include <cmath>
#include <optional>

#include "services/messages/check.h"
#include "services/messages/header.h"

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMaxArrivals = 10'000;

// Several processes count on these channels, each for itself; their name follows.
bool IsShared(const std::string& channel) {
  return channel == "STATUS" || channel == "POSE" || channel == "SESSION_EVENT";
}

// The sender's name, a string after the header (session_event_t: after `command`).
std::string SenderOf(const std::string& channel, const std::uint8_t* data, std::size_t size) {
  if (!IsShared(channel)) return "";
  const std::size_t at = kHeaderBytes + (channel == "SESSION_EVENT" ? 8 : 0);
  if (size < at + 4) return "";
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) length = length << 8 | data[at + i];
  if (length == 0 || length > kMaxNameBytes || size < at + 4 + length) return "";
  return {reinterpret_cast<const char*>(data + at + 4), length - 1};
}

}  // namespace

void BusMonitor::Add(const std::string& channel, const std::uint8_t* data, std::size_t size,
                     double now_s, Utime now_utime) {
  if (channels_.size() >= kMaxChannels && channels_.count(channel) == 0) return;
  Channel& c = channels_[channel];
  ++c.count;
  c.size = size;
  c.newest.push_back({now_s, size});
  while (!c.newest.empty() &&
         (c.newest.front().at_s < now_s - kWindow || c.newest.size() > kMaxArrivals)) {
    c.newest.pop_front();
  }
  const std::optional<Header> header = HeaderOf(data, size);
  if (!header) return;
  // The bytes are not checked: numbers that no message may have are passed over.
  c.latency_s = header->utime > 0 ? ToSeconds(now_utime - header->utime) : 0;
  c.has_latency = header->utime > 0 && std::abs(c.latency_s) < kSameClock;
  const std::int64_t seq = header->seq;
  const std::string sender = SenderOf(channel, data, size);
  if (seq < 0 || seq > kMaxInteger ||
      (c.senders.size() >= kMaxChannels && c.senders.count(sender) == 0))
    return;
  c.lost += c.senders[sender].Add(seq).gaps;
}

nlohmann::json BusMonitor::Channels(double now_s) const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [name, c] : channels_) {
    std::size_t bytes = 0;
    std::size_t count = 0;
    for (const Arrival& arrival : c.newest) {
      if (arrival.at_s < now_s - kWindow) continue;
      bytes += arrival.bytes;
      ++count;
    }
    all.push_back({{"name", Printable(name, 100)},
                   {"count", c.count},
                   {"rate_hz", static_cast<double>(count) / kWindow},
                   {"bytes_per_s", static_cast<double>(bytes) / kWindow},
                   {"size_bytes", c.size},
                   {"latency_ms", c.has_latency ? nlohmann::json(c.latency_s * 1e3) : nullptr},
                   {"lost", c.lost}});
  }
  return all;
}

}  // namespace rgbdt::viewer
