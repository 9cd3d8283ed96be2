#pragma once

#include <array>
#include <list>
#include <memory>

#include "viewer/server/internal/hub.h"
#include "viewer/server/internal/net.h"
#include "viewer/server/internal/stream.h"

namespace rgbdt::viewer {

/// A new connection: reads one request, answers it and closes, or becomes a Browser. Lives as long
/// as one of its operations does; all on the server's thread.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(tcp::socket socket, Hub* hub);
  ~HttpConnection();
  void Start();
  /// Ends it, for another one's sake.
  void Drop();

 private:
  void OnFirstBytes(const beast::error_code& error, bool is_tls);
  void ReadHeader();
  void OnRequest(const beast::error_code& error);
  void Answer(HttpResponse response);
  void Drain();

  Stream stream_;
  Hub* hub_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  HttpResponse response_;
  std::array<char, 4096> rest_{};
  std::list<HttpConnection*>::iterator place_;  // among the hub's
};

}  // namespace rgbdt::viewer
