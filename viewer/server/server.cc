#include "viewer/server/server.h"

#include <netinet/tcp.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <thread>
#include <utility>

#include "calib/model/errors.h"
#include "viewer/server/internal/acceptor.h"
#include "viewer/server/internal/http_connection.h"
#include "viewer/server/internal/hub.h"
#include "viewer/server/internal/message.h"
#include "viewer/server/internal/tls_context.h"
#include "viewer/server/listening_socket.h"

namespace rgbdt::viewer {
namespace {

constexpr std::chrono::milliseconds kRetryTime{200};
constexpr int kSendBufferBytes = 256 * 1024;
constexpr unsigned kStuckMs = 60'000;

// A modest buffer, so that a browser that stalls is noticed early; and one that takes nothing at
// all for a minute is given up, whatever it sends.
void SetSocketOptions(tcp::socket* socket) {
  beast::error_code ignored;
  socket->set_option(tcp::no_delay(true), ignored);
  socket->set_option(net::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  setsockopt(socket->native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &kStuckMs, sizeof(kStuckMs));
}

// "0.0.0.0" is no address to open.
std::string AddressToOpen(const net::ip::address& bound) {
  if (!bound.is_unspecified()) return AddressText(bound);
  beast::error_code ignored;
  const std::string name = net::ip::host_name(ignored);
  return name.empty() ? "localhost" : name;
}

[[noreturn]] void FailOption(const std::string& field, const std::string& value,
                             const std::string& expected) {
  throw InputError(field + " is " + value + "; expected " + expected);
}

bool IsTokenCharacter(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
         c == '_';
}

// "https://app.foxglove.dev", "http://localhost:8081", "file://"
bool IsOrigin(const std::string& origin) {
  const std::size_t scheme = origin.find("://");
  const auto is_plain = [](char c) { return c > ' ' && c < 0x7f && c != '/' && c != '*'; };
  return origin.size() <= kMaxMessageString && scheme != 0 && scheme != std::string::npos &&
         std::all_of(origin.begin(), origin.begin() + static_cast<std::ptrdiff_t>(scheme),
                     is_plain) &&
         std::all_of(origin.begin() + static_cast<std::ptrdiff_t>(scheme) + 3, origin.end(),
                     is_plain);
}

}  // namespace

void ServerOptions::Check() const {
  beast::error_code error;
  net::ip::make_address(address, error);
  if (error) FailOption("address", "\"" + address + "\"", "an IPv4 or IPv6 address");
  if (port < 0 || port > 65535) FailOption("port", std::to_string(port), "0 to 65535");
  if (socket < -1) FailOption("socket", std::to_string(socket), "-1 or a descriptor");
  if (token.size() > kMaxMessageString ||
      !std::all_of(token.begin(), token.end(), IsTokenCharacter)) {
    FailOption("token", std::to_string(token.size()) + " characters",
               "200 at most of letters, digits, - and _");
  }
  for (const std::string& origin : foxglove_origins) {
    if (!IsOrigin(origin)) {
      FailOption("foxglove_origins", "\"" + origin + "\"",
                 "SCHEME://HOST as a browser sends it, e.g. https://app.foxglove.dev");
    }
  }
  if (!hello.is_null() && !hello.is_object()) {
    FailOption("hello", hello.type_name(), "a JSON object");
  }
  if (tls) tls->Check();
}

struct Server::Impl {
  Impl(ServerOptions checked, OnMessage on_message);
  ~Impl();
  void Run();
  void WakeForChannels() {
    net::post(io, [this] { hub.channels.Dispatch(); });
  }
  void Accept();
  void OnAccept(const beast::error_code& error, tcp::socket socket);

  const ServerOptions options;
  std::optional<net::ssl::context> tls;
  // Connections end with `io`: it goes before what they share.
  Hub hub;
  net::io_context io{1};
  tcp::acceptor acceptor;
  net::steady_timer retry;
  std::thread thread;
};

Server::Impl::Impl(ServerOptions checked, OnMessage on_message)
    : options(std::move(checked)),
      tls(options.tls ? std::optional(TlsContext(*options.tls)) : std::nullopt),
      hub(options, std::move(on_message)),
      acceptor(options.socket >= 0 ? ListenOn(&io, options.socket)
                                   : ListenAt(&io, options.address, options.port)),
      retry(io) {
  const tcp::endpoint bound = acceptor.local_endpoint();
  const std::string name = AddressToOpen(bound.address());
  hub.tls = tls ? &*tls : nullptr;
  hub.site.hosts = RuleFor(AddressText(bound.address()), bound.port(), tls.has_value());
  hub.site.url = (tls ? "https://" : "http://") + HostPortText(name, bound.port());
  Accept();
  thread = std::thread([this] { Run(); });
}

Server::Impl::~Impl() {
  io.stop();
  thread.join();
}

// What a handler throws (there is no memory, say) is its loss alone.
void Server::Impl::Run() {
  const int of_others = getpriority(PRIO_PROCESS, 0);
  setpriority(PRIO_PROCESS, 0, of_others + kNiceness);  // on Linux of this thread alone
  while (!io.stopped()) {
    try {
      io.run();
    } catch (...) {
    }
  }
}

void Server::Impl::Accept() {
  acceptor.async_accept([this](const beast::error_code& error, tcp::socket socket) {
    OnAccept(error, std::move(socket));
  });
}

void Server::Impl::OnAccept(const beast::error_code& error, tcp::socket socket) {
  if (error) {  // most often no descriptor is left: it would fail again at once
    retry.expires_after(kRetryTime);
    retry.async_wait([this](const beast::error_code& stopped) {
      if (!stopped) Accept();
    });
    return;
  }
  Accept();
  if (hub.http_connections.size() >= kMaxHttpConnections) hub.http_connections.front()->Drop();
  SetSocketOptions(&socket);
  std::make_shared<HttpConnection>(std::move(socket), &hub)->Start();
}

Server::Server(ServerOptions options, OnMessage on_message) {
  options.Check();
  impl_ = std::make_unique<Impl>(std::move(options), std::move(on_message));
}

Server::~Server() = default;

void Server::Send(Post post) {
  if (!impl_->hub.posts.Send(std::move(post))) return;
  net::post(impl_->io, [impl = impl_.get()] { impl->hub.Dispatch(); });
}

void Server::Forget(const std::string& topic_prefix) { impl_->hub.posts.Forget(topic_prefix); }

void Server::Publish(ChannelMessage message) {
  if (impl_->hub.channels.Publish(std::move(message))) impl_->WakeForChannels();
}

void Server::EndChannels() {
  if (impl_->hub.channels.End()) impl_->WakeForChannels();
}

bool Server::AnybodyListens() const { return impl_->hub.channels.AnybodyListens(); }

std::string Server::FoxgloveUrl() const {
  const std::string& token = impl_->options.token;
  const std::string& url = impl_->hub.site.url;  // "http" becomes "ws"
  return "ws" + url.substr(4) + (token.empty() ? "" : "/?token=" + token);
}

std::string Server::Url() const {
  const std::string& token = impl_->options.token;
  return impl_->hub.site.url + (token.empty() ? "" : "/#token=" + token);
}

std::vector<BrowserState> Server::Browsers() const { return impl_->hub.roster.States(); }

std::optional<ScreenTimes> Server::Screen() const { return impl_->hub.screen.Percentiles(); }

}  // namespace rgbdt::viewer
