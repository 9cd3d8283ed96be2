#pragma once

#include <array>
#include <memory>

#include "viewer/server/internal/hub.h"
#include "viewer/server/internal/net.h"

namespace rgbdt::viewer {

/// A new connection: reads one request, answers it and closes, or becomes a Browser. Lives as long
/// as one of its operations does; all on the server's thread.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(tcp::socket socket, Hub* hub);
  ~HttpConnection();
  void Start();

 private:
  void OnRequest(const beast::error_code& error);
  void Answer(HttpResponse response);
  void Drain();

  beast::tcp_stream stream_;
  Hub* hub_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  HttpResponse response_;
  std::array<char, 4096> rest_{};
};

}  // namespace rgbdt::viewer
