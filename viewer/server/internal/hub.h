#pragma once

#include <boost/asio/ssl/context.hpp>
#include <list>
#include <string>
#include <vector>

#include "viewer/server/internal/channels.h"
#include "viewer/server/internal/http_answer.h"
#include "viewer/server/internal/limits.h"
#include "viewer/server/internal/post_store.h"
#include "viewer/server/internal/roster.h"
#include "viewer/server/internal/screen_ring.h"
#include "viewer/server/server.h"

namespace rgbdt::viewer {

class Browser;
class HttpConnection;

/// What the server's connections share. Its posts, channels, roster and screen times are there for
/// other threads, too; all else is the server's thread's.
class Hub {
 public:
  Hub(const ServerOptions& options, Server::OnMessage on_message);

  /// Hands what was sent to the browsers.
  void Dispatch();
  /// Likewise, and gives what is kept: what is in it comes to nobody a second time.
  std::vector<SharedPost> DispatchThenKept();

  void Join(Browser* browser) { browsers_.push_back(browser); }
  void Leave(Browser* browser);
  bool full() const { return browsers_.size() + channels.listeners() >= kMaxBrowsers; }

  /// A Hello's bytes.
  std::string HelloFrame(bool may_command) const;
  bool MayCommand(const std::string& token) const;
  /// What is to be said to the browser.
  std::vector<Post> Ask(const nlohmann::json& message) const;

  Site site;
  PostStore posts;
  Channels channels;
  Roster roster;
  ScreenRing screen;
  net::ssl::context* tls = nullptr;             ///< none: in clear
  std::list<HttpConnection*> http_connections;  ///< the oldest first
  std::size_t web_sockets = 0;                  ///< those that are told to go, too

 private:
  void Offer(const std::vector<SharedPost>& posts);

  nlohmann::json hello_;
  Server::OnMessage on_message_;
  std::vector<Browser*> browsers_;
};

/// What a browser without the token is told.
extern const char* const kTokenAdvice;

/// A NoticeFrame of level "error".
Post ErrorNotice(const std::string& text);

}  // namespace rgbdt::viewer
