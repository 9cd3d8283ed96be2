#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <exception>
#include <optional>
#include <thread>

#include "calib/model/errors.h"
#include "services/bus/internal/group_socket.h"
#include "services/bus/internal/inbox.h"
#include "services/bus/internal/source.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxDatagramBytes = 65536;
constexpr int kDatagramsAtOnce = 100;  // then it looks whether it is to stop
constexpr auto kTestPatience = std::chrono::seconds(10);
constexpr int kTestPeriodMs = 100;

std::string Text(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return std::string(text.data()) + ":" + std::to_string(ntohs(address.sin_port));
}

class UdpSource : public Source {
 public:
  explicit UdpSource(const BusUrl& url)
      : socket_(OpenGroupSocket(url)), stop_(eventfd(0, EFD_CLOEXEC)), buffer_(kMaxDatagramBytes) {
    if (!stop_) throw InputError("too many files are open");
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

  void Subscribe(const std::string& channel_regex, int capacity, Bus::Handler handler) override {
    inbox_.Subscribe(channel_regex, static_cast<std::size_t>(capacity), std::move(handler));
  }
  int descriptor() const override { return inbox_.descriptor(); }
  bool Deliver() override {
    inbox_.DeliverOne();
    return true;
  }
  Malformed malformed() const override { return inbox_.malformed(); }

 private:
  // The next datagram into the buffer; false: none waits.
  bool Receive() {
    socklen_t length = sizeof sender_;
    const ssize_t got = recvfrom(socket_.get(), buffer_.data(), buffer_.size(), 0,
                                 reinterpret_cast<sockaddr*>(&sender_), &length);
    size_ = got < 0 ? 0 : static_cast<std::size_t>(got);
    return got >= 0;
  }

  void Take() {
    const char* why = nullptr;
    std::optional<WholeMessage> message;
    if (const auto datagram = ParseDatagram(buffer_.data(), size_, &why)) {
      message = reassembly_.Add({sender_.sin_addr.s_addr, sender_.sin_port}, *datagram, &why);
    }
    if (why != nullptr) inbox_.AddMalformed(Text(sender_) + ": " + why);
    if (message) inbox_.Add(std::move(*message));
  }

  void Run() {
    std::array<pollfd, 2> readable{{{socket_.get(), POLLIN, 0}, {stop_.get(), POLLIN, 0}}};
    while (readable[1].revents == 0) {
      for (int i = 0; i < kDatagramsAtOnce && Receive(); ++i) {
        try {
          Take();
        } catch (const std::exception&) {
          // No memory for it: it is lost, as in a full buffer, and leaves a gap.
        }
      }
      poll(readable.data(), readable.size(), -1);
    }
  }

  Descriptor socket_, stop_;
  Bytes buffer_;
  std::size_t size_ = 0;
  sockaddr_in sender_{};
  Inbox inbox_;
  Reassembly reassembly_{[this](const std::string& channel) { return inbox_.IsWanted(channel); }};
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Source> MakeUdpSource(const std::string& url,
                                      const std::function<void()>& send_test) {
  const BusUrl parsed = ParseBusUrl(url);
  if (!parsed.error.empty()) throw InputError(parsed.error);
  auto source = std::make_unique<UdpSource>(parsed);
  if (!source->Hears(send_test)) return nullptr;
  source->Start();
  return source;
}

}  // namespace rgbdt
