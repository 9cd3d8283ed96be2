#include "tests/hardware/scip_peer.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rgbdt {
namespace {

double NowUs() {
  using Us = std::chrono::duration<double, std::micro>;
  return std::chrono::duration_cast<Us>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// A line with its sum and line feed.
std::string Line(const std::string& text) {
  int sum = 0;
  for (const char c : text) sum += c;
  return text + static_cast<char>(sum % 64 + 48) + "\n";
}

// "NAME:value;sum", the sum being of what stands before the semicolon.
std::string Property(const std::string& text) {
  const std::string line = Line(text);
  return text + ";" + line.substr(text.size());
}

std::string Encode(std::uint32_t value, int characters) {
  std::string text(static_cast<std::size_t>(characters), '0');
  for (auto c = text.rbegin(); c != text.rend(); ++c, value /= 64) {
    *c = static_cast<char>(48 + value % 64);
  }
  return text;
}

bool SendAll(int socket, const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

struct ScipPeer::Client {
  int socket = -1;
  std::string received;
  bool open = true;
  bool measuring = false, silent = false;
  std::string measure;  // the command, without its number of scans
  std::int64_t next = 0;
};

ScipPeer::ScipPeer(ScipPeerOptions options) : options_(std::move(options)) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(options_.port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* raw = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  if (listener_ < 0 || bind(listener_, raw, size) != 0 || listen(listener_, 1) != 0 ||
      getsockname(listener_, raw, &size) != 0) {
    throw std::runtime_error("no TCP port " + std::to_string(options_.port) + " on 127.0.0.1");
  }
  port_ = ntohs(address.sin_port);
  epoch_us_ = NowUs();
  time_mode_on_ = options_.time_mode_on;
  thread_ = std::thread([this] { Run(); });
}

ScipPeer::~ScipPeer() {
  stopping_ = true;
  thread_.join();
  close(listener_);
}

void ScipPeer::Inject(Fault fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  faults_.push_back(fault);
}

bool ScipPeer::TakeFault(Fault fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = std::find(faults_.begin(), faults_.end(), fault);
  if (found == faults_.end()) return false;
  faults_.erase(found);
  return true;
}

std::vector<std::string> ScipPeer::commands() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return commands_;
}

Utime ScipPeer::StepZero(std::int64_t index) const {
  return static_cast<Utime>(
      std::llround(epoch_us_ + static_cast<double>(index) * 60e6 / options_.rpm));
}

double ScipPeer::DeviceMs(double utime) const {
  return options_.clock_start_ms + (utime - epoch_us_) * options_.clock_rate / 1000;
}

void ScipPeer::Run() {
  while (!stopping_) {
    pollfd waiting{listener_, POLLIN, 0};
    if (poll(&waiting, 1, 10) <= 0) continue;
    const int socket = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) continue;
    ++clients_;
    Serve(socket);
    close(socket);
  }
}

void ScipPeer::Serve(int socket) {
  const int yes = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  Client client;
  client.socket = socket;
  while (!stopping_ && client.open) {
    pollfd waiting{socket, POLLIN, 0};
    if (poll(&waiting, 1, client.measuring ? 1 : 10) > 0) {
      char bytes[256];
      const ssize_t n = recv(socket, bytes, sizeof(bytes), 0);
      if (n <= 0) return;
      client.received.append(bytes, static_cast<std::size_t>(n));
    }
    for (std::size_t end = 0; (end = client.received.find('\n')) != std::string::npos;) {
      const std::string command = client.received.substr(0, end);
      client.received.erase(0, end + 1);
      Answer(&client, command);
    }
    if (client.measuring) client.open = client.open && SendDueScan(&client);
  }
}

void ScipPeer::Answer(Client* client, const std::string& command) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    commands_.push_back(command);
  }
  const std::string verb = command.substr(0, 2);
  if (time_mode_on_ && verb != "TM") return;
  const auto number = [](const std::string& text) { return text + "\n"; };
  std::string reply = command + "\n";
  if (verb == "QT" || verb == "RS" || verb == "BM") {
    client->measuring = false;
    reply += "00P\n";
  } else if (command == "SCIP2.0") {
    reply += "0\n";
  } else if (verb == "VV") {
    reply += "00P\n" + Property("VEND:Hokuyo Automatic Co.,Ltd.") + Property("PROT:SCIP 2.0");
  } else if (verb == "PP") {
    reply += "00P\n" + Property("MODL:" + options_.model);
    for (const auto& [name, value] :
         {std::pair("DMIN", options_.least_mm), std::pair("DMAX", options_.most_mm),
          std::pair("ARES", options_.steps), std::pair("AMIN", options_.first_step),
          std::pair("AMAX", options_.last_step), std::pair("AFRT", options_.front_step),
          std::pair("SCAN", options_.rpm)}) {
      reply += Property(std::string(name) + ":" + std::to_string(value));
    }
  } else if (verb == "TM" && options_.time_mode) {
    const bool on = command.substr(2, 1) == "0";
    if (command.substr(2, 1) == "1") {
      const auto ms = static_cast<std::int64_t>(std::floor(DeviceMs(NowUs())));
      reply += time_mode_on_ ? "00P\n" + Line(Encode(static_cast<std::uint32_t>(ms % (1 << 24)), 4))
                             : number("04T");
    } else {
      reply += time_mode_on_ == on ? number(on ? "02R" : "03S") : number("00P");
      time_mode_on_ = on;
    }
  } else if (command.size() >= 15 && (verb == "MD" || (verb == "ME" && options_.intensities))) {
    client->measuring = true;
    client->measure = command.substr(0, 13);
    const double turns = (NowUs() - epoch_us_) * options_.rpm / 60e6;
    client->next = static_cast<std::int64_t>(turns) + 1;
    reply += "00P\n";
  } else {
    reply += "0Ee\n";
  }
  client->open = SendAll(client->socket, reply + "\n");
}

// False once the client is gone.
bool ScipPeer::SendDueScan(Client* client) {
  const double step_us = 60e6 / options_.rpm / options_.steps;
  const double jitter = std::fmod(static_cast<double>(client->next) * 0.618, 1);
  const double due = static_cast<double>(StepZero(client->next)) + options_.last_step * step_us +
                     1000 * (options_.send_ms + jitter * options_.send_jitter_ms);
  if (NowUs() < due) return true;
  if (TakeFault(Fault::kClose)) return false;
  if (TakeFault(Fault::kSilent)) client->silent = true;
  const std::int64_t index = client->next++;
  return client->silent || SendScan(client, index);
}

bool ScipPeer::SendScan(Client* client, std::int64_t index) {
  const double ms = DeviceMs(epoch_us_ + static_cast<double>(index) * 60e6 / options_.rpm);
  const ScipPeerScan scan = options_.scan(index, ms);
  const bool intensities = client->measure[1] == 'E';
  std::string data;
  for (std::size_t i = 0; i < scan.range_mm.size(); ++i) {
    data += Encode(scan.range_mm[i], 3);
    if (intensities) data += Encode(scan.intensity[i], 3);
  }
  const auto stamp = static_cast<std::int64_t>(std::floor(ms)) % (1 << 24);
  std::string bytes =
      client->measure + "00\n99b\n" + Line(Encode(static_cast<std::uint32_t>(stamp), 4));
  const std::size_t first_data = bytes.size();
  for (std::size_t at = 0; at < data.size(); at += 64) bytes += Line(data.substr(at, 64));
  bytes += "\n";
  if (TakeFault(Fault::kBadChecksum)) bytes[first_data + 7] ^= 1;
  if (TakeFault(Fault::kRubbish)) bytes = std::string("\x01\xff%n rubbish\n0\n\n\n\n") + bytes;
  const bool pieces = TakeFault(Fault::kPieces);
  const std::size_t piece = pieces ? 100 : bytes.size();
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    if (!SendAll(client->socket, bytes.substr(at, piece))) return false;
    if (pieces) std::this_thread::yield();
  }
  ++scans_sent_;
  return true;
}

}  // namespace rgbdt
