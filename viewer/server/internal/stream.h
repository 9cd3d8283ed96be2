#pragma once

#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <utility>
#include <variant>

#include "viewer/server/internal/net.h"

namespace rgbdt::viewer {

/// A connection that is in clear until BeginTls. What Beast asks of a stream, so that all that
/// reads and writes is compiled once, for both.
class Stream {
 public:
  using Clear =
      beast::basic_stream<tcp, beast::tcp_stream::executor_type, beast::simple_rate_policy>;
  using Tls = beast::ssl_stream<Clear>;
  using next_layer_type = Clear;
  using executor_type = Clear::executor_type;

  explicit Stream(tcp::socket socket) : stream_(std::in_place_type<Clear>, std::move(socket)) {}

  executor_type get_executor() noexcept { return next_layer().get_executor(); }
  next_layer_type& next_layer() noexcept {
    if (auto* tls = std::get_if<Tls>(&stream_)) return tls->next_layer();
    return *std::get_if<Clear>(&stream_);
  }
  const next_layer_type& next_layer() const noexcept {
    return const_cast<Stream*>(this)->next_layer();
  }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& s) { s.async_read_some(buffers, std::forward<Handler>(handler)); },
               stream_);
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& s) { s.async_write_some(buffers, std::forward<Handler>(handler)); },
               stream_);
  }

  /// Nothing is being read or written. `read`: what of TLS came already; the handler gets an error
  /// and how much of it was used.
  template <typename Buffers, typename Handler>
  void BeginTls(net::ssl::context* context, const Buffers& read, Handler&& handler) {
    Clear clear = std::move(std::get<Clear>(stream_));
    Tls& tls = stream_.emplace<Tls>(std::move(clear), *context);
    tls.async_handshake(net::ssl::stream_base::server, read, std::forward<Handler>(handler));
  }

  /// Says that nothing more is sent. The handler gets an error.
  template <typename Handler>
  void EndSending(Handler&& handler) {
    if (auto* tls = std::get_if<Tls>(&stream_)) {
      tls->async_shutdown(std::forward<Handler>(handler));
      return;
    }
    beast::error_code error;
    next_layer().socket().shutdown(tcp::socket::shutdown_send, error);
    net::post(get_executor(),
              [error, handler = std::forward<Handler>(handler)]() mutable { handler(error); });
  }

 private:
  std::variant<Clear, Tls> stream_;
};

// A WebSocket's end: its own closing handshake is over, and vouches for it by TLS, too.
inline void teardown(beast::role_type role, Stream& stream, beast::error_code& error) {
  beast::websocket::teardown(role, stream.next_layer().socket(), error);
}
template <typename Handler>
void async_teardown(beast::role_type role, Stream& stream, Handler&& handler) {
  beast::websocket::async_teardown(role, stream.next_layer().socket(),
                                   std::forward<Handler>(handler));
}

}  // namespace rgbdt::viewer
