#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "viewer/server/channel_outbox.h"
#include "viewer/server/outbox.h"
#include "viewer/server/tls.h"

namespace rgbdt::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6
  int port = 8080;                    ///< 0: any free one
  /// A listening socket handed in (LISTEN_FDS) in place of address and port; -1: none.
  int socket = -1;
  /// Commands are taken from browsers that know it; empty: from all that may connect.
  std::string token;
  /// Pages of other sites that may connect as Foxglove does: "https://app.foxglove.dev".
  std::vector<std::string> foxglove_origins;
  /// By TLS, and by it alone; empty: in clear.
  std::optional<TlsIdentity> tls;
  std::string page;      ///< HTML of the page
  nlohmann::json hello;  ///< a Hello without may_command and why_not

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// A browser's state, for the Bus panel.
struct BrowserState {
  std::string address;
  std::size_t waiting = 0;   ///< posts
  std::int64_t thinned = 0;  ///< posts dropped or cut for it
  double share = 1;          ///< of the points that it gets now
};

/// From the bus to drawn [ms], of the newest 200 frames.
struct ScreenTimes {
  double p50 = 0, p95 = 0;
  int count = 0;
};

/// HTTP and WebSocket for any number of browsers, in a thread of its own that gives way to others.
/// GET / is the page, GET /ws its WebSocket, and a WebSocket at / one for clients that speak
/// Foxglove's protocol, which look and command nothing. A request whose Host is not this server's,
/// or whose Origin is another one's, is refused; of Foxglove's clients one of another Origin may
/// connect that is named in the options or has the token behind "/?token=", and one without an
/// Origin. What a browser says is checked: a malformed frame closes that browser's connection only.
/// A browser that reads slowly gets less, newest first, and holds up nobody.
class Server : public Outbox, public ChannelOutbox {
 public:
  /// What a browser asked for, already checked in type and form: "request", "pick", "leave_out",
  /// "view", "watch". Called on the server's thread; answers with frames for that browser alone. An
  /// InputError becomes a notice.
  using OnMessage = std::function<std::vector<Post>(const nlohmann::json& message)>;

  /// Listens. Throws InputError: which address, why, and what to do.
  Server(ServerOptions options, OnMessage on_message);
  ~Server() override;

  void Send(Post post) override;
  void Forget(const std::string& topic_prefix) override;

  void Publish(ChannelMessage message) override;
  void EndChannels() override;
  bool AnybodyListens() const override;

  /// "http://127.0.0.1:8080", by TLS "https://..."; with the token, where there is one, behind
  /// "/#token=".
  std::string Url() const;

  /// For Foxglove: "ws://127.0.0.1:8080", by TLS "wss://..."; the token behind "/?token=".
  std::string FoxgloveUrl() const;

  std::vector<BrowserState> Browsers() const;  ///< Foxglove's clients, too
  std::optional<ScreenTimes> Screen() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The listening socket handed in by who started this process, as systemd does (sd_listen_fds(3));
/// -1: none. Throws InputError where more than one was handed in.
int HandedInSocket();

}  // namespace rgbdt::viewer
