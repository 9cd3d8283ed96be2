#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "calib/model/errors.h"
#include "services/bus/internal/group_socket.h"
#include "services/bus/internal/inbox.h"
#include "services/bus/internal/repaired_streams.h"
#include "services/bus/internal/source.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxDatagramBytes = 65536;
constexpr int kDatagramsAtOnce = 100;  // then it looks whether it is to stop
constexpr auto kTestPatience = std::chrono::seconds(10);
constexpr int kTestPeriodMs = 100;

constexpr Utime kLongestWaitMs = 1000;

std::string Text(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return std::string(text.data()) + ":" + std::to_string(ntohs(address.sin_port));
}

class UdpSource : public Source {
 public:
  UdpSource(const BusUrl& url, UdpSender* sender)
      : socket_(OpenGroupSocket(url)),
        stop_(eventfd(0, EFD_CLOEXEC)),
        buffer_(kMaxDatagramBytes),
        sender_(sender) {
    if (!stop_) throw InputError("too many files are open");
    const int on = 1;
    if (sender_ != nullptr) setsockopt(socket_.get(), SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on);
  }

  ~UdpSource() override {
    if (!thread_.joinable()) return;
    eventfd_write(stop_.get(), 1);
    thread_.join();
  }

  // Whether the bus's own messages come back. Before Start.
  bool Hears(const std::function<void()>& send_test) {
    const Clock::time_point end = Clock::now() + kTestPatience;
    while (Clock::now() < end) {
      send_test();
      pollfd readable{socket_.get(), POLLIN, 0};
      poll(&readable, 1, kTestPeriodMs);
      while (Receive()) {
        const char* why = nullptr;
        const std::optional<Datagram> datagram = ParseDatagram(buffer_.data(), size_, &why);
        if (datagram && datagram->channel == kSelfTestChannel) return true;
      }
    }
    return false;
  }

  // Signals are for the thread that handles.
  void Start() {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this] { Run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  void Subscribe(const std::string& channel_regex, const Room& room,
                 Bus::Handler handler) override {
    inbox_.Subscribe(channel_regex, room, std::move(handler));
  }
  int descriptor() const override { return inbox_.descriptor(); }
  bool Deliver() override {
    inbox_.DeliverOne();
    return true;
  }
  Malformed malformed() const override { return inbox_.malformed(); }
  LinkReport links() const override {
    if (sender_ == nullptr) return {};
    const std::lock_guard<std::mutex> lock(streams_mutex_);
    LinkReport report = streams_.report();
    report.ip_fragments_given_up = ReassemblyFailures() - reassembly_failures_;
    return report;
  }
  Utime arrived() const override { return inbox_.arrived(); }

 private:
  // The next datagram into the buffer; false: none waits.
  bool Receive() {
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timeval))> control{};
    iovec into{buffer_.data(), buffer_.size()};
    msghdr message{};
    message.msg_name = &from_;
    message.msg_namelen = sizeof from_;
    message.msg_iov = &into;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = recvmsg(socket_.get(), &message, 0);
    size_ = got < 0 ? 0 : static_cast<std::size_t>(got);
    came_ = sender_ == nullptr || got < 0 ? 0 : ArrivalOf(&message);
    return got >= 0;
  }

  // By the kernel, on the wall clock [us]: on a busy machine it is read much later.
  static Utime ArrivalOf(msghdr* message) {
    const cmsghdr* stamp = CMSG_FIRSTHDR(message);
    if (stamp == nullptr || stamp->cmsg_type != SCM_TIMESTAMP) return HostUtime();
    timeval time{};
    std::memcpy(&time, CMSG_DATA(stamp), sizeof time);
    return time.tv_sec * kMicrosecondsPerSecond + time.tv_usec;
  }

  void Take() {
    const char* why = nullptr;
    if (const auto datagram = ParseDatagram(buffer_.data(), size_, &why)) {
      if (!datagram->is_fragment && datagram->channel == kRepairChannel) {
        TakeRepair(*datagram, &why);
      } else {
        TakeMessage(*datagram, &why);
      }
    }
    if (why != nullptr) inbox_.AddMalformed(Text(from_) + ": " + why);
  }

  Reassembly::Sender From() const { return {from_.sin_addr.s_addr, from_.sin_port}; }

  void TakeMessage(const Datagram& datagram, const char** why) {
    if (sender_ != nullptr) {
      const std::lock_guard<std::mutex> lock(streams_mutex_);
      const bool taken = streams_.Add(From(), datagram, SteadyUtime(), why);
      if (taken) return DeliverStreams();
    }
    auto message = reassembly_.Add(From(), datagram, why);
    if (message) inbox_.Add(std::move(*message));
  }

  // Senders and receivers of what is lost. Not for a bus that stays on its machine.
  void TakeRepair(const Datagram& datagram, const char** why) {
    if (sender_ == nullptr) return;
    const RepairMessage message = DecodeRepairMessage(datagram.data, datagram.size);
    const std::lock_guard<std::mutex> lock(streams_mutex_);
    if (const auto* beat = std::get_if<Beat>(&message)) {
      streams_.OnBeat(From(), *beat, SteadyUtime(), came_);
    } else if (const auto* request = std::get_if<RepairRequest>(&message)) {
      streams_.OnRequest(*request, SteadyUtime());
      sender_->Answer(*request);
    } else if (const auto* repair = std::get_if<Repair>(&message)) {
      const auto lost = ParseDatagram(repair->datagram.data(), repair->datagram.size(), why);
      if (lost) streams_.AddRepair(From(), *lost, SteadyUtime(), why);
    } else {
      *why = "no message of those that repair what is lost";
    }
    DeliverStreams();
  }

  void DeliverStreams() {
    for (WholeMessage& message : streams_.Take()) inbox_.Add(std::move(message));
  }

  // What is due by time. Until when there is nothing more [ms]; below 0: until something comes.
  int Tend() {
    if (sender_ == nullptr) return -1;
    const std::lock_guard<std::mutex> lock(streams_mutex_);
    const Utime now = SteadyUtime();
    for (const RepairRequest& request : streams_.Ask(now)) sender_->Ask(request);
    DeliverStreams();
    sender_->BeatIfDue(now);
    Utime next = sender_->NextBeat();
    if (const auto ask = streams_.NextAsk()) next = std::min(next, *ask);
    return static_cast<int>(std::clamp<Utime>((next - now + 999) / 1000, 1, kLongestWaitMs));
  }

  bool Stopped(const pollfd& stop) const {
    return stop.revents != 0 && (sender_ == nullptr || !sender_->WaitsForRequests(SteadyUtime()));
  }

  void Run() {
    std::array<pollfd, 2> readable{{{socket_.get(), POLLIN, 0}, {stop_.get(), POLLIN, 0}}};
    while (!Stopped(readable[1])) {
      for (int i = 0; i < kDatagramsAtOnce && Receive(); ++i) {
        try {
          Take();
        } catch (const std::exception&) {
          // No memory for it: it is lost, as in a full buffer, and leaves a gap.
        }
      }
      const int wait_ms = Tend();
      // Once it is to stop, the other descriptor is always readable.
      poll(readable.data(), readable[1].revents == 0 ? 2 : 1, wait_ms);
    }
  }

  Descriptor socket_, stop_;
  Bytes buffer_;
  std::size_t size_ = 0;
  sockaddr_in from_{};
  Utime came_ = 0;
  Inbox inbox_;
  Reassembly reassembly_{[this](const std::string& channel) { return inbox_.IsWanted(channel); }};
  // Of a bus that leaves its machine.
  UdpSender* sender_;
  mutable std::mutex streams_mutex_;
  RepairedStreams streams_{[this](const std::string& channel) { return inbox_.IsWanted(channel); }};
  std::int64_t reassembly_failures_ = ReassemblyFailures();  // before this
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Source> MakeUdpSource(const BusUrl& url, const std::function<void()>& send_test,
                                      UdpSender* sender) {
  auto source = std::make_unique<UdpSource>(url, sender);
  if (!source->Hears(send_test)) return nullptr;
  source->Start();
  return source;
}

}  // namespace rgbdt
