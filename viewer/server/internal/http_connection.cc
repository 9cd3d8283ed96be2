#include "viewer/server/internal/http_connection.h"

#include <utility>

#include "viewer/server/internal/browser.h"
#include "viewer/server/internal/foxglove_client.h"

namespace rgbdt::viewer {
namespace {

bool IsMalformed(const beast::error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

HttpConnection::HttpConnection(tcp::socket socket, Hub* hub)
    : stream_(std::move(socket)), hub_(hub), buffer_(kMaxHeaderBytes) {
  place_ = hub_->http_connections.insert(hub_->http_connections.end(), this);
}

HttpConnection::~HttpConnection() {
  if (place_ != hub_->http_connections.end()) hub_->http_connections.erase(place_);
}

// Its operations end with an error, and it with them.
void HttpConnection::Drop() {
  hub_->http_connections.erase(std::exchange(place_, hub_->http_connections.end()));
  stream_.next_layer().close();
}

void HttpConnection::Start() {
  parser_.header_limit(kMaxHeaderBytes);
  stream_.next_layer().expires_after(kRequestTime);
  if (hub_->tls == nullptr) return ReadHeader();
  beast::async_detect_ssl(stream_.next_layer(), buffer_,
                          [self = shared_from_this()](const beast::error_code& error, bool is_tls) {
                            self->OnFirstBytes(error, is_tls);
                          });
}

void HttpConnection::OnFirstBytes(const beast::error_code& error, bool is_tls) {
  if (error) return;
  if (!is_tls) {
    return Answer(PlainAnswer(http::status::bad_request,
                              "This server speaks TLS: write https:// before its address, as in " +
                                  hub_->site.url + "."));
  }
  stream_.BeginTls(hub_->tls, buffer_.data(),
                   [self = shared_from_this()](const beast::error_code& refused, std::size_t used) {
                     if (refused) return;
                     self->buffer_.consume(used);
                     self->ReadHeader();
                   });
}

void HttpConnection::ReadHeader() {
  http::async_read_header(stream_, buffer_, parser_,
                          [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                            self->OnRequest(error);
                          });
}

void HttpConnection::OnRequest(const beast::error_code& error) {
  if (IsMalformed(error)) {
    return Answer(PlainAnswer(http::status::bad_request, "That is no HTTP request."));
  }
  if (error) return;
  if (auto response = AnswerTo(parser_.get(), hub_->site)) return Answer(std::move(*response));
  if (hub_->web_sockets >= kMaxWebSockets) {
    return Answer(PlainAnswer(http::status::service_unavailable,
                              "Too many browsers are connected; close one of them."));
  }
  if (buffer_.size() > 0) {
    return Answer(
        PlainAnswer(http::status::bad_request, "Nothing is to be sent before the answer."));
  }
  const HttpRequest request = parser_.release();
  if (PathOf(request) == kPagesSocket) {
    return std::make_shared<Browser>(std::move(stream_), hub_)->Start(request);
  }
  std::make_shared<FoxgloveClient>(std::move(stream_), hub_)
      ->Start(request, FoxgloveSubprotocolOf(request));
}

void HttpConnection::Answer(HttpResponse response) {
  response_ = std::move(response);
  stream_.next_layer().expires_after(kAnswerTime);
  http::async_write(stream_, response_,
                    [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                      if (error) return;
                      self->stream_.next_layer().expires_after(kDrainTime);
                      self->stream_.EndSending([self](const beast::error_code&) { self->Drain(); });
                    });
}

// Closed with a request's body unread, TCP would take the answer back.
void HttpConnection::Drain() {
  stream_.next_layer().async_read_some(
      net::buffer(rest_), [self = shared_from_this()](const beast::error_code& error, std::size_t) {
        if (!error) self->Drain();
      });
}

}  // namespace rgbdt::viewer
