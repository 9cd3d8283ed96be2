#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "viewer/server/internal/hub.h"
#include "viewer/server/internal/net.h"
#include "viewer/server/internal/stream.h"

namespace rgbdt::viewer {

/// A WebSocket: its place among the others, its limits, its end. Who derives says what is read from
/// it and written to it. Lives as long as one of its operations does; all on the server's thread.
class WebSocket : public std::enable_shared_from_this<WebSocket> {
 public:
  virtual ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  /// Accepts the upgrade; with a subprotocol where one is named.
  void Start(const HttpRequest& request, const std::string& subprotocol = "");

 protected:
  using CloseCode = beast::websocket::close_code;

  /// Where there are too many it is told so once it is open, and closed.
  WebSocket(Stream stream, Hub* hub);

  virtual void OnStart() {}
  virtual void OnOpen() {}
  /// Throws MalformedMessage for what makes no sense: the other end is told, and it is closed.
  virtual void OnText(const std::string& text) = 0;
  /// What was being written is: there is room for more.
  virtual void OnWritten() = 0;

  /// Called once, at its end; there is room, so whoever derives has joined the hub.
  void LeaveBy(std::function<void()> leave) { leave_ = std::move(leave); }
  /// Writes one message. One at a time; the bytes stay until OnWritten.
  template <typename Buffers>
  void Write(const Buffers& buffers, bool text) {
    writing_ = true;
    socket_.text(text);
    socket_.async_write(buffers,
                        [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                          self->writing_ = false;
                          if (!error) self->OnWritten();
                        });
  }
  void Close(CloseCode code, const char* reason);
  /// It is closed, for that reason, unless the deadline is stopped.
  void StartDeadline(std::chrono::seconds time, const char* reason);
  void StopDeadline() { deadline_.cancel(); }
  void End();
  /// For the Bus panel.
  void Tell(std::size_t waiting, std::int64_t thinned, double share);

  Hub* hub() const { return hub_; }
  bool one_too_many() const { return one_too_many_; }
  bool may_write() const { return !writing_ && !closing_; }
  bool closing() const { return closing_; }

 private:
  void SetOptions(const std::string& subprotocol);
  void Read();
  void OnRead(const beast::error_code& error);

  static constexpr bool kMayCompress = false;  // points and JPEG gain nothing by it
  beast::websocket::stream<Stream, kMayCompress> socket_;
  Hub* hub_;
  std::uint64_t line_ = 0;  // of the roster
  net::steady_timer deadline_;
  beast::flat_buffer buffer_;
  std::function<void()> leave_;
  bool one_too_many_ = false;
  bool writing_ = false;
  bool closing_ = false;
  bool ended_ = false;
};

}  // namespace rgbdt::viewer
