#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "viewer/server/server.h"

namespace rgbdt::viewer {

/// Of a server on 127.0.0.1.
int PortOf(const Server& server);

/// Sends these bytes to that port and gives all that comes back until the end.
std::string Exchange(int port, const std::string& request);

/// A connection that is held open, with whatever is said on it.
class HeldConnection {
 public:
  explicit HeldConnection(int port);
  /// What the other end does not take is lost.
  void Say(const std::string& bytes);
  /// The other end has not closed it. What came is passed over.
  bool IsOpen();
  /// Reads until these bytes have come. Throws where they do not.
  void Await(const std::string& bytes);

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_{io_};
};

/// A GET request as a browser sends it, but for the fields named.
std::string GetRequest(const std::string& target, const std::string& host,
                       const std::string& more_fields = "");

/// A frame as it came, see protocol.ts.
struct GotFrame {
  std::uint32_t id = 0;
  nlohmann::json header;
  std::string payload;
  std::string name() const { return header.value("name", ""); }
  std::string type() const { return header.value("type", ""); }
};

/// A message of a WebSocket as it came.
struct GotMessage {
  bool is_text = false;
  std::string bytes;
  nlohmann::json Json() const { return nlohmann::json::parse(bytes); }
};

/// What a client's first request says.
struct Handshake {
  std::string origin = {};  ///< empty: the server's own page; "none": it says none
  std::string target = "/ws";
  std::string subprotocol = {};  ///< offered
};

/// A browser's end of the WebSocket. What takes longer than 30 s throws.
class TestBrowser {
 public:
  /// Connects. Throws boost::system::system_error where it is refused.
  TestBrowser(int port, const Handshake& handshake);
  explicit TestBrowser(int port, const std::string& origin = "")
      : TestBrowser(port, Handshake{origin}) {}
  explicit TestBrowser(const Server& server) : TestBrowser(PortOf(server)) {}

  void Say(const nlohmann::json& message) { SayText(message.dump()); }
  void SayText(const std::string& text, bool binary = false);
  /// Bytes as they are, in place of a WebSocket frame.
  void SayRaw(const std::string& bytes);
  /// Says hello and reads the answer.
  GotFrame Hello(const std::string& token = "");
  void Watch(bool cloud, const std::vector<std::string>& cameras, std::int64_t points = 10'000'000);
  void Ack(std::uint32_t id) { Say({{"type", "ack"}, {"id", id}}); }

  /// The next message, whatever it is. Throws where the connection was closed instead.
  GotMessage NextMessage();
  /// The subprotocol that the server chose.
  const std::string& subprotocol() const { return subprotocol_; }
  /// The next frame. Throws where the connection was closed instead.
  GotFrame Next();
  /// Reads up to the close, and gives its code.
  int CloseCode();
  std::string CloseReason() const;

 private:
  using Done = std::function<void(const boost::system::error_code& error)>;
  boost::system::error_code Await(const std::function<void(Done done)>& start);
  void Check(const boost::system::error_code& error);

  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  std::string subprotocol_;
};

/// A post whose frame is {"type": "test", "name": `name`}.
Post LightPost(const std::string& topic, const std::string& name, bool kept = false);

/// Likewise, large, with `records` records of 4 bytes: their numbers, little-endian.
Post CloudPost(const std::string& topic, const std::string& name, std::uint32_t records);

/// What CloudPost() put into the payload.
std::string Records(std::uint32_t records);

}  // namespace rgbdt::viewer
