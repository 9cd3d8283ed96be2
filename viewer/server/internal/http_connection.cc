#include "viewer/server/internal/http_connection.h"

#include <chrono>
#include <utility>

#include "viewer/server/internal/browser.h"

namespace rgbdt::viewer {
namespace {

constexpr std::chrono::seconds kRequestTime{30};
constexpr std::chrono::seconds kDrainTime{2};
constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;

bool IsMalformed(const beast::error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_method).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

HttpConnection::HttpConnection(tcp::socket socket, Hub* hub)
    : stream_(std::move(socket)), hub_(hub), buffer_(kMaxHeaderBytes) {
  ++hub_->http_connections;
}

HttpConnection::~HttpConnection() { --hub_->http_connections; }

void HttpConnection::Start() {
  parser_.header_limit(kMaxHeaderBytes);
  stream_.expires_after(kRequestTime);
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
  if (hub_->full()) {
    return Answer(PlainAnswer(http::status::service_unavailable,
                              "Too many browsers are connected; close one of them."));
  }
  if (buffer_.size() > 0) {
    return Answer(
        PlainAnswer(http::status::bad_request, "Nothing is to be sent before the answer."));
  }
  std::make_shared<Browser>(std::move(stream_), hub_)->Start(parser_.release());
}

void HttpConnection::Answer(HttpResponse response) {
  response_ = std::move(response);
  stream_.expires_after(kRequestTime);
  http::async_write(stream_, response_,
                    [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                      if (error) return;
                      beast::error_code ignored;
                      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      self->stream_.expires_after(kDrainTime);
                      self->Drain();
                    });
}

// Closed with a request's body unread, TCP would take the answer back.
void HttpConnection::Drain() {
  stream_.async_read_some(net::buffer(rest_),
                          [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                            if (!error) self->Drain();
                          });
}

}  // namespace rgbdt::viewer
