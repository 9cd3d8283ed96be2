#include "test_browser.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "calib/present/layout/frame.h"

namespace rgbdt::viewer {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
using tcp = net::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kPatience{30};

tcp::endpoint Loopback(int port) {
  return {net::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)};
}

std::uint32_t LittleEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
  }
  return value;
}

GotFrame Decoded(const std::string& bytes) {
  const std::size_t size = LittleEndian(bytes, 4);
  return {LittleEndian(bytes, 0), nlohmann::json::parse(bytes.substr(8, size)),
          bytes.substr(8 + size)};
}

}  // namespace

int PortOf(const Server& server) {
  const std::string url = server.Url().substr(0, server.Url().find("/#"));
  return std::stoi(url.substr(url.rfind(':') + 1));
}

std::string GetRequest(const std::string& target, const std::string& host,
                       const std::string& more_fields) {
  return "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + more_fields + "\r\n";
}

std::string Exchange(int port, const std::string& request) {
  net::io_context io;
  tcp::socket socket(io);
  socket.connect(Loopback(port));
  net::write(socket, net::buffer(request));
  std::string answer;
  error_code error;
  net::read(socket, net::dynamic_buffer(answer), error);
  if (error != net::error::eof) throw boost::system::system_error(error);
  return answer;
}

HeldConnection::HeldConnection(int port) { socket_.connect(Loopback(port)); }

void HeldConnection::Say(const std::string& bytes) {
  error_code lost;
  net::write(socket_, net::buffer(bytes), lost);
}

bool HeldConnection::IsOpen() {
  error_code error;
  socket_.non_blocking(true);
  std::string bytes(1000, '\0');
  while (!error && socket_.read_some(net::buffer(bytes), error) > 0) {
  }
  socket_.non_blocking(false);
  return error == net::error::would_block;
}

void HeldConnection::Await(const std::string& bytes) {
  std::string came;
  net::read_until(socket_, net::dynamic_buffer(came), bytes);
}

TestBrowser::TestBrowser(int port, const Handshake& handshake) : socket_(io_) {
  const std::string host = "127.0.0.1:" + std::to_string(port);
  const std::string from = handshake.origin.empty() ? "http://" + host : handshake.origin;
  beast::get_lowest_layer(socket_).socket().connect(Loopback(port));
  socket_.set_option(beast::websocket::stream_base::decorator(
      [from, offered = handshake.subprotocol](beast::websocket::request_type& request) {
        if (from != "none") request.set(beast::http::field::origin, from);
        if (!offered.empty()) request.set(beast::http::field::sec_websocket_protocol, offered);
      }));
  beast::websocket::response_type response;
  Check(Await(
      [&](const Done& done) { socket_.async_handshake(response, host, handshake.target, done); }));
  subprotocol_ = std::string(response[beast::http::field::sec_websocket_protocol]);
}

error_code TestBrowser::Await(const std::function<void(Done done)>& start) {
  error_code result;
  bool done = false;
  start([&](const error_code& error) {
    result = error;
    done = true;
  });
  const auto until = std::chrono::steady_clock::now() + kPatience;
  io_.restart();
  while (!done) {
    if (io_.run_one_until(until) == 0) throw std::runtime_error("nothing came for 30 s");
  }
  return result;
}

void TestBrowser::Check(const error_code& error) {
  if (error) throw boost::system::system_error(error);
}

void TestBrowser::SayText(const std::string& text, bool binary) {
  socket_.binary(binary);
  Check(Await([&](const Done& done) {
    socket_.async_write(net::buffer(text),
                        [done](const error_code& error, std::size_t) { done(error); });
  }));
}

void TestBrowser::SayRaw(const std::string& bytes) {
  net::write(beast::get_lowest_layer(socket_).socket(), net::buffer(bytes));
}

GotMessage TestBrowser::NextMessage() {
  beast::flat_buffer buffer;
  Check(Await([&](const Done& done) {
    socket_.async_read(buffer, [done](const error_code& error, std::size_t) { done(error); });
  }));
  return {socket_.got_text(), beast::buffers_to_string(buffer.data())};
}

GotFrame TestBrowser::Next() { return Decoded(NextMessage().bytes); }

int TestBrowser::CloseCode() {
  try {
    while (true) NextMessage();
  } catch (const boost::system::system_error&) {
    return socket_.reason().code;
  }
}

std::string TestBrowser::CloseReason() const { return socket_.reason().reason.c_str(); }

GotFrame TestBrowser::Hello(const std::string& token) {
  Say({{"type", "hello"}, {"token", token}});
  return Next();
}

void TestBrowser::Watch(bool cloud, const std::vector<std::string>& cameras, std::int64_t points) {
  Say({{"type", "watch"},
       {"cloud", cloud},
       {"cameras", cameras},
       {"overlay_cloud", false},
       {"points", points}});
}

Post LightPost(const std::string& topic, const std::string& name, bool kept) {
  Post post;
  post.topic = topic;
  post.kept = kept;
  post.make = [name] { return JsonFrame({{"type", "test"}, {"name", name}}); };
  return post;
}

Post CloudPost(const std::string& topic, const std::string& name, std::uint32_t records) {
  Post post;
  post.topic = topic;
  post.watch = "cloud";
  post.kept = false;
  post.heavy = true;
  post.record_bytes = 4;
  post.make = [name, records] {
    FrameWriter frame({{"type", "cloud"}, {"name", name}, {"ack", true}});
    frame.AddBytes("points", Records(records));
    return frame.Finish();
  };
  return post;
}

std::string Records(std::uint32_t records) {
  std::string bytes;
  for (std::uint32_t record = 0; record < records; ++record) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(record >> shift));
  }
  return bytes;
}

}  // namespace rgbdt::viewer
