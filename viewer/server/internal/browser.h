#pragma once

#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/server/internal/browser_queue.h"
#include "viewer/server/internal/hub.h"
#include "viewer/server/internal/net.h"
#include "viewer/server/internal/stream.h"

namespace rgbdt::viewer {

/// A browser's WebSocket: reads what it says, writes what waits for it. Lives as long as one of its
/// operations does; all on the server's thread.
class Browser : public std::enable_shared_from_this<Browser> {
 public:
  Browser(Stream stream, Hub* hub);
  ~Browser();

  /// Accepts the upgrade.
  void Start(const HttpRequest& request);
  void Offer(const std::vector<SharedPost>& posts);

 private:
  using CloseCode = beast::websocket::close_code;

  void SetOptions();
  void Read();
  void OnRead(const beast::error_code& error);
  void Handle(const nlohmann::json& message);
  void OnHello(const nlohmann::json& message);
  void OnWatch(const nlohmann::json& message);
  void OnAck(const nlohmann::json& message);
  void Ask(const nlohmann::json& message);
  void Answer(std::vector<Post> posts);

  void Pump();
  void Write(BrowserQueue::Outgoing next);
  void Close(CloseCode code, const char* reason);
  void StartDeadline(std::chrono::seconds time);
  void End();

  static constexpr bool kMayCompress = false;  // points and JPEG gain nothing by it
  beast::websocket::stream<Stream, kMayCompress> socket_;
  Hub* hub_;
  std::uint64_t line_ = 0;      // of the roster
  net::steady_timer deadline_;  // of its hello, then of its close
  beast::flat_buffer buffer_;
  BrowserQueue queue_;
  bool one_too_many_ = false;
  bool greeted_ = false;  // it said hello
  bool may_command_ = false;
  bool writing_ = false;
  bool closing_ = false;
  bool ended_ = false;
  BrowserQueue::Outgoing outgoing_;  // being written
  std::array<unsigned char, 4> id_bytes_{};
};

}  // namespace rgbdt::viewer
