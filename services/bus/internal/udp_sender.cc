#include "services/bus/internal/udp_sender.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <random>

#include "calib/model/errors.h"
#include "services/bus/host_name.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

constexpr Utime kLongestBeat = kMicrosecondsPerSecond;
constexpr Utime kLinger = 200'000;  // a receiver has asked by then, several times
constexpr std::size_t kAtOnce = 64;
constexpr int kPatienceMs = 1000;  // for room in the kernel's buffers, since it last took one

sockaddr_in GroupOf(const BusUrl& url) {
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_addr.s_addr = htonl(url.group);
  group.sin_port = htons(static_cast<std::uint16_t>(url.port));
  return group;
}

// By the route to the group, as LCM does. Heard on this machine, too.
Descriptor OpenSendSocket(const BusUrl& url) {
  Descriptor udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto ttl = static_cast<std::uint8_t>(url.ttl);
  const std::uint8_t on = 1;
  if (!udp || setsockopt(udp.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl) != 0 ||
      setsockopt(udp.get(), IPPROTO_IP, IP_MULTICAST_LOOP, &on, sizeof on) != 0) {
    throw InputError(std::string("a socket to send by: ") + std::strerror(errno));
  }
  return udp;
}

// All of them. Throws InputError.
void SendAll(int udp, std::vector<mmsghdr>* messages) {
  std::size_t sent = 0;
  int waited_ms = 0;
  while (sent < messages->size()) {
    const int count = sendmmsg(udp, messages->data() + sent,
                               static_cast<unsigned>(messages->size() - sent), MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
      waited_ms = 0;
    } else if (errno == ENOBUFS || errno == EAGAIN) {
      // Not by POLLOUT: it tells of the socket's buffer, not of the interface's queue.
      if (waited_ms++ == kPatienceMs) throw InputError(std::strerror(ENOBUFS));
      poll(nullptr, 0, 1);
    } else if (errno != EINTR) {
      throw InputError(std::strerror(errno));
    }
  }
}

void SendMessage(int udp, sockaddr_in to, const SentMessage& message) {
  for (std::size_t begin = 0; begin < message.datagrams(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, message.datagrams() - begin);
    std::vector<Bytes> headers(count);
    std::vector<std::array<iovec, 2>> parts(count);
    std::vector<mmsghdr> datagrams(count);
    for (std::size_t i = 0; i < count; ++i) {
      headers[i] = message.Header(begin + i);
      const auto [data, size] = message.Data(begin + i);
      parts[i] = {
          {{headers[i].data(), headers[i].size()}, {const_cast<std::uint8_t*>(data), size}}};
      datagrams[i].msg_hdr.msg_name = &to;
      datagrams[i].msg_hdr.msg_namelen = sizeof to;
      datagrams[i].msg_hdr.msg_iov = parts[i].data();
      datagrams[i].msg_hdr.msg_iovlen = parts[i].size();
    }
    SendAll(udp, &datagrams);
  }
}

}  // namespace

UdpSender::UdpSender(const BusUrl& url)
    : socket_(OpenSendSocket(url)), group_(GroupOf(url)), host_(HostName()) {
  std::random_device lot;
  id_ = static_cast<std::uint64_t>(lot()) << 32 | lot();
}

void UdpSender::Publish(const std::string& channel, const Bytes& bytes) {
  if (!SentMessage::Fits(channel, bytes.size())) {
    throw InputError("larger than 65535 datagrams");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  published_ = SteadyUtime();
  pause_ = kFirstBeat;
  beat_at_ = std::min(published_ + pause_, beaten_ + kLongestBeat);
  const SentMessage& message = sent_.Add(channel, bytes, published_);
  datagrams_ += message.datagrams();
  SendMessage(socket_.get(), group_, message);
}

void UdpSender::Answer(const RepairRequest& request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (request.id != id_) return;
  for (const Bytes& datagram : sent_.Repeat(request.parts, SteadyUtime())) {
    Bytes wrapped{kRepairMark};
    wrapped.insert(wrapped.end(), datagram.begin(), datagram.end());
    SendControl(wrapped);
  }
}

void UdpSender::Ask(const RepairRequest& request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  SendControl(Encode(request));
}

// Best effort: what is lost here is asked for, or said, again.
void UdpSender::SendControl(const Bytes& payload) {
  Bytes bytes;
  bytes.reserve(SentMessage::kDatagramBytes + 50);
  for (const char c : {'L', 'C', '0', '2', '\0', '\0', '\0', '\0'}) {
    bytes.push_back(static_cast<std::uint8_t>(c));
  }
  bytes.insert(bytes.end(), kRepairChannel, kRepairChannel + sizeof kRepairChannel);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  sendto(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&group_), sizeof group_);
}

void UdpSender::SendBeat() {
  beaten_ = SteadyUtime();
  SendControl(Encode(Beat{id_, sent_.oldest(), sent_.next(), datagrams_, HostUtime(), host_}));
}

void UdpSender::BeatIfDue(Utime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (now < beat_at_) return;
  SendBeat();
  beat_at_ = now + pause_;
  pause_ = std::min(2 * pause_, kLongestBeat);
}

Utime UdpSender::NextBeat() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return beat_at_;
}

bool UdpSender::WaitsForRequests(Utime now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return published_ != 0 && now - published_ < kLinger;
}

}  // namespace rgbdt
