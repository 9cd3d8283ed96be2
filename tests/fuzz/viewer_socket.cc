// What comes over a connection to the viewer's server: raw where the first byte is even, else
// behind a handshake that makes a WebSocket of it, the page's or (3, 7, ...) a Foxglove client's.
// Whoever sends hears an end, whatever it was.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "calib/model/descriptor.h"
#include "tests/fuzz/fuzz.h"
#include "viewer/server/server.h"

namespace rgbdt {
namespace {

viewer::Post MakePost(const std::string& topic, const std::string& watch) {
  viewer::Post post;
  post.topic = topic;
  post.watch = watch;
  post.make = [] { return std::string(40, '\0'); };
  return post;
}

viewer::ChannelMessage MakeMessage(const std::string& topic, const std::string& holds_for) {
  viewer::ChannelMessage message;
  message.topic = topic;
  message.schema_name = "test.Bytes";
  message.schema = std::make_shared<const std::string>("schema");
  message.holds_for = holds_for;
  message.make = [] { return std::string(40, '\0'); };
  return message;
}

viewer::ServerOptions Options() {
  viewer::ServerOptions options;
  options.port = 0;
  options.token = "secret";
  options.page = "<html></html>";
  options.hello = nlohmann::json::object();
  return options;
}

int PortOf(const viewer::Server& server) {
  const std::string url = server.Url().substr(0, server.Url().find("/#"));
  return std::stoi(url.substr(url.rfind(':') + 1));
}

std::string Handshake(int port, bool foxglove) {
  const std::string host = "127.0.0.1:" + std::to_string(port);
  return std::string(foxglove ? "GET /" : "GET /ws") + " HTTP/1.1\r\nHost: " + host +
         (foxglove ? "\r\nSec-WebSocket-Protocol: foxglove.websocket.v1"
                   : "\r\nOrigin: http://" + host) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

// From a loopback address of its own, as one has not ports enough for so many connections.
void BindToAnother(int connection) {
  static std::uint32_t count = 0;
  constexpr std::uint32_t kFirst = 0x7f010001, kMost = 0xfff0;  // 127.1.0.1
  const int later = 1;
  setsockopt(connection, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &later, sizeof(later));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(kFirst + count++ % kMost);
  fuzz::Require(bind(connection, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0,
                std::string("a loopback address: ") + std::strerror(errno));
}

Descriptor Connect(int port) {
  Descriptor connection(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  BindToAnother(connection.get());
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  fuzz::Require(
      connect(connection.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0,
      "a server that takes connections");
  return connection;
}

// Where the server has closed before all was read, the kernel says so here.
void Send(int connection, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t sent = send(connection, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;
    at += static_cast<std::size_t>(sent);
  }
}

// What comes next; empty at the end.
std::string Receive(int connection) {
  constexpr int kPatience_ms = 20'000;
  char bytes[4096];
  pollfd wait{connection, POLLIN, 0};
  int ready = 0;
  do {  // libFuzzer looks at its clock by signals
    ready = poll(&wait, 1, kPatience_ms);
  } while (ready < 0 && errno == EINTR);
  fuzz::Require(ready == 1, "an answer, or an end");
  const ssize_t got = recv(connection, bytes, sizeof(bytes), 0);
  return got <= 0 ? std::string() : std::string(bytes, bytes + got);
}

// Nothing is to be sent before its answer.
void ShakeHands(int connection, int port, bool foxglove) {
  Send(connection, Handshake(port, foxglove));
  std::string answer;
  while (answer.find("\r\n\r\n") == std::string::npos) {
    const std::string more = Receive(connection);
    fuzz::Require(!more.empty(), "a handshake that is taken; it is answered " + answer);
    answer += more;
  }
  fuzz::Require(answer.find(" 101 ") != std::string::npos, "a WebSocket; the answer is " + answer);
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static viewer::Server server(Options(), [](const nlohmann::json& message) {
    if (message["type"] == "view") throw InputError("no such view");
    return std::vector<viewer::Post>{MakePost("answer", "")};
  });
  static const int port = PortOf(server);
  fuzz::Input input(data, size);
  const std::uint8_t kind = input.Byte();
  const bool handshake = kind % 2 == 1;
  const std::string bytes = input.Rest();
  server.Send(MakePost("sweep/0", "cloud"));
  server.Publish(MakeMessage("/tf_static", "rgb"));
  server.Publish(MakeMessage("/status", ""));
  const Descriptor connection = Connect(port);
  if (handshake) ShakeHands(connection.get(), port, kind % 4 == 3);
  Send(connection.get(), bytes);
  shutdown(connection.get(), SHUT_WR);
  while (!Receive(connection.get()).empty()) {
  }
  return 0;
}
