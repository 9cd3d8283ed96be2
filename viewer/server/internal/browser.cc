#include "viewer/server/internal/browser.h"

#include <chrono>
#include <set>
#include <utility>

#include "viewer/server/internal/acceptor.h"
#include "viewer/server/internal/frame_layout.h"
#include "viewer/server/internal/message.h"
#include "viewer/server/internal/steady_seconds.h"
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

std::set<std::string> WatchKeys(const nlohmann::json& watch) {
  std::set<std::string> keys;
  if (watch["cloud"].get<bool>()) keys.insert("cloud");
  for (const auto& camera : watch["cameras"]) {
    const auto name = camera.get<std::string>();
    keys.insert("camera/" + name);
    keys.insert("overlay/" + name);
  }
  return keys;
}

}  // namespace

Browser::Browser(Stream stream, Hub* hub)
    : socket_(std::move(stream)),
      hub_(hub),
      deadline_(socket_.get_executor()),
      one_too_many_(hub->full()) {
  ++hub_->web_sockets;
  if (one_too_many_) return;
  BrowserState state;
  state.address = PeerText(beast::get_lowest_layer(socket_));
  line_ = hub_->roster.Add(std::move(state));
  hub_->Join(this);
}

Browser::~Browser() { End(); }

// It is no browser of the hub's any more; its operations run out.
void Browser::End() {
  if (std::exchange(ended_, true)) return;
  closing_ = true;
  --hub_->web_sockets;
  if (one_too_many_) return;
  hub_->Leave(this);
  hub_->roster.Remove(line_);
}

void Browser::SetOptions() {
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has times of its own
  websocket::stream_base::timeout times{};
  times.handshake_timeout = kHandshakeTime;
  times.idle_timeout = kIdleTime;
  times.keep_alive_pings = true;
  socket_.set_option(times);
  socket_.auto_fragment(false);
  socket_.binary(true);
  socket_.read_message_max(kMaxMessageText);
  beast::get_lowest_layer(socket_).rate_policy().read_limit(kMaxReadPerSecond);
}

void Browser::Start(const HttpRequest& request) {
  SetOptions();
  StartDeadline(kHelloTime);
  socket_.async_accept(request, [self = shared_from_this()](const beast::error_code& error) {
    if (error) {
      self->End();
      self->deadline_.cancel();
    } else {
      if (self->one_too_many_) self->Close(CloseCode::try_again_later, kOneTooMany);
      self->Read();
    }
  });
}

void Browser::StartDeadline(std::chrono::seconds time) {
  deadline_.expires_after(time);
  deadline_.async_wait([weak = weak_from_this()](const beast::error_code& error) {
    const auto self = weak.lock();
    if (error || !self) return;
    if (self->closing_) {
      beast::get_lowest_layer(self->socket_).close();
    } else {
      self->Close(CloseCode::policy_error, "no hello");
    }
  });
}

void Browser::Read() {
  socket_.async_read(buffer_, [self = shared_from_this()](const beast::error_code& error,
                                                          std::size_t) { self->OnRead(error); });
}

void Browser::OnRead(const beast::error_code& error) {
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
    Handle(ParseMessage(beast::buffers_to_string(buffer_.data())));
  } catch (const MalformedMessage& malformed) {
    Close(malformed.is_json() ? CloseCode::policy_error : CloseCode::bad_payload, malformed.what());
  } catch (const std::exception&) {  // of whatever kind: it costs this browser only
    Close(CloseCode::internal_error, "internal error");
  }
  buffer_.consume(buffer_.size());
  if (!closing_) Read();
}

void Browser::Handle(const nlohmann::json& message) {
  const auto& type = message["type"].get_ref<const std::string&>();
  if (greeted_ == (type == "hello")) {
    throw MalformedMessage(true, greeted_ ? "hello twice" : "hello must come first");
  }
  if (type == "hello") return OnHello(message);
  if (type == "ack") return OnAck(message);
  if (type == "watch") return OnWatch(message);
  if ((type == "request" || type == "pick" || type == "leave_out") && !may_command_) {
    return Answer({ErrorNotice(kTokenAdvice)});
  }
  Ask(message);
}

void Browser::OnHello(const nlohmann::json& message) {
  const auto kept = hub_->DispatchThenKept();  // not yet greeted: nothing of it comes here
  greeted_ = true;
  deadline_.cancel();
  may_command_ = hub_->MayCommand(message["token"].get_ref<const std::string&>());
  Post hello;
  hello.topic = "hello";
  hello.make = [frame = hub_->HelloFrame(may_command_)] { return frame; };
  queue_.Replay(std::make_shared<LazyPost>(std::move(hello)));
  for (const SharedPost& post : kept) queue_.Replay(post);
  Pump();
}

void Browser::OnWatch(const nlohmann::json& message) {
  const auto kept = hub_->DispatchThenKept();
  const auto added = queue_.Watch(WatchKeys(message), message["points"].get<std::int64_t>());
  for (const SharedPost& post : kept) {
    if (added.count(post->post().watch) != 0) queue_.Replay(post);
  }
  Ask(message);
}

void Browser::OnAck(const nlohmann::json& message) {
  const auto sent_s = queue_.Acked(message["id"].get<std::uint32_t>());
  if (sent_s) hub_->screen.Add(SteadySeconds() - *sent_s);
  Pump();
}

void Browser::Ask(const nlohmann::json& message) { Answer(hub_->Ask(message)); }

void Browser::Answer(std::vector<Post> posts) {
  for (Post& post : posts) queue_.Offer(std::make_shared<LazyPost>(std::move(post)));
  Pump();
}

void Browser::Offer(const std::vector<SharedPost>& posts) {
  if (!greeted_ || closing_) return;
  for (const SharedPost& post : posts) queue_.Offer(post);
  Pump();
}

void Browser::Pump() {
  std::optional<BrowserQueue::Outgoing> next;
  if (!writing_ && !closing_) next = queue_.Next();
  if (!ended_) hub_->roster.Update(line_, queue_.waiting(), queue_.thinned(), queue_.share());
  if (next) Write(std::move(*next));
}

void Browser::Write(BrowserQueue::Outgoing next) {
  writing_ = true;
  outgoing_ = std::move(next);
  for (std::size_t i = 0; i < id_bytes_.size(); ++i) {
    id_bytes_[i] = static_cast<unsigned char>(outgoing_.id >> (8 * i));
  }
  const std::array<net::const_buffer, 2> buffers = {
      net::buffer(id_bytes_),
      net::buffer(outgoing_.frame->data() + kIdBytes, outgoing_.bytes - kIdBytes)};
  socket_.async_write(buffers,
                      [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                        self->writing_ = false;
                        self->outgoing_ = {};
                        if (!error) self->Pump();
                      });
}

void Browser::Close(CloseCode code, const char* reason) {
  if (std::exchange(closing_, true)) return;
  StartDeadline(kCloseTime);  // a browser that does not read would not answer
  socket_.async_close({code, reason}, [self = shared_from_this()](const beast::error_code&) {
    self->End();
    self->deadline_.cancel();
    beast::get_lowest_layer(self->socket_).close();
  });
}

}  // namespace rgbdt::viewer
