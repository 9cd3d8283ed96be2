#include "viewer/server/internal/web_socket.h"

#include <utility>

#include "viewer/server/internal/acceptor.h"
#include "viewer/server/internal/message.h"
#include "viewer/server/listening_socket.h"

namespace rgbdt::viewer {
namespace {

namespace websocket = beast::websocket;

constexpr const char* kOneTooMany = "Too many browsers are connected; close one of them.";

std::string PeerText(const Stream::Clear& stream) {
  beast::error_code error;
  const tcp::endpoint peer = stream.socket().remote_endpoint(error);
  return error ? "" : HostPortText(AddressText(peer.address()), peer.port());
}

}  // namespace

WebSocket::WebSocket(Stream stream, Hub* hub)
    : socket_(std::move(stream)),
      hub_(hub),
      deadline_(socket_.get_executor()),
      one_too_many_(hub->full()) {
  ++hub_->web_sockets;
  if (one_too_many_) return;
  BrowserState state;
  state.address = PeerText(beast::get_lowest_layer(socket_));
  line_ = hub_->roster.Add(std::move(state));
}

WebSocket::~WebSocket() { End(); }

// It is none of the hub's any more; its operations run out.
void WebSocket::End() {
  if (std::exchange(ended_, true)) return;
  closing_ = true;
  --hub_->web_sockets;
  if (one_too_many_) return;
  if (leave_) leave_();
  hub_->roster.Remove(line_);
}

void WebSocket::Tell(std::size_t waiting, std::int64_t thinned, double share) {
  if (!ended_) hub_->roster.Update(line_, waiting, thinned, share);
}

void WebSocket::SetOptions(const std::string& subprotocol) {
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has times of its own
  websocket::stream_base::timeout times{};
  times.handshake_timeout = kHandshakeTime;
  times.idle_timeout = kIdleTime;
  times.keep_alive_pings = true;
  socket_.set_option(times);
  if (!subprotocol.empty()) {
    socket_.set_option(
        websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, subprotocol);
        }));
  }
  socket_.auto_fragment(false);
  socket_.read_message_max(kMaxMessageText);
  beast::get_lowest_layer(socket_).rate_policy().read_limit(kMaxReadPerSecond);
}

void WebSocket::Start(const HttpRequest& request, const std::string& subprotocol) {
  SetOptions(subprotocol);
  OnStart();
  socket_.async_accept(request, [self = shared_from_this()](const beast::error_code& error) {
    if (error) {
      self->End();
      self->deadline_.cancel();
      return;
    }
    if (self->one_too_many_) {
      self->Close(CloseCode::try_again_later, kOneTooMany);
    } else {
      self->OnOpen();
    }
    self->Read();
  });
}

void WebSocket::StartDeadline(std::chrono::seconds time, const char* reason) {
  deadline_.expires_after(time);
  deadline_.async_wait([weak = weak_from_this(), reason](const beast::error_code& error) {
    const auto self = weak.lock();
    if (error || !self) return;
    if (self->closing_) {
      beast::get_lowest_layer(self->socket_).close();
    } else {
      self->Close(CloseCode::policy_error, reason);
    }
  });
}

void WebSocket::Read() {
  socket_.async_read(buffer_, [self = shared_from_this()](const beast::error_code& error,
                                                          std::size_t) { self->OnRead(error); });
}

void WebSocket::OnRead(const beast::error_code& error) {
  if (error) {
    // Nothing more is to be heard; a write that is stuck must not keep the socket.
    End();
    deadline_.cancel();
    beast::get_lowest_layer(socket_).close();
    return;
  }
  if (closing_) return;
  try {
    if (!socket_.got_text()) throw MalformedMessage(true, "binary message");
    OnText(beast::buffers_to_string(buffer_.data()));
  } catch (const MalformedMessage& malformed) {
    Close(malformed.is_json() ? CloseCode::policy_error : CloseCode::bad_payload, malformed.what());
  } catch (const std::exception&) {  // of whatever kind: it costs this one only
    Close(CloseCode::internal_error, "internal error");
  }
  buffer_.consume(buffer_.size());
  if (!closing_) Read();
}

void WebSocket::Close(CloseCode code, const char* reason) {
  if (std::exchange(closing_, true)) return;
  StartDeadline(kCloseTime, "");  // who does not read would not answer
  socket_.async_close({code, reason}, [self = shared_from_this()](const beast::error_code&) {
    self->End();
    self->deadline_.cancel();
    beast::get_lowest_layer(self->socket_).close();
  });
}

}  // namespace rgbdt::viewer
