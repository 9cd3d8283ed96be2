#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "test_browser.h"
#include "viewer/server/server.h"

namespace rgbdt::viewer {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class ServerHttpTest : public ::testing::Test {
 protected:
  static ServerOptions Options() {
    ServerOptions options;
    options.port = 0;
    options.page = "<!DOCTYPE html><p>the page";
    return options;
  }
  std::string Get(const std::string& target, const std::string& more = "") const {
    return Exchange(port_, GetRequest(target, host_, more));
  }
  std::string UpgradeRequest(const std::string& origin_field) const {
    return GetRequest("/ws", host_,
                      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
                          origin_field);
  }
  std::string Upgrade(const std::string& origin_field) const {
    return Exchange(port_, UpgradeRequest(origin_field));
  }

  Server server_{Options(), nullptr};
  int port_ = PortOf(server_);
  std::string host_ = "127.0.0.1:" + std::to_string(port_);
};

TEST_F(ServerHttpTest, UrlIsWhatToOpen) { EXPECT_EQ(server_.Url(), "http://" + host_); }

TEST_F(ServerHttpTest, ServesThePageWithItsHeaders) {
  for (const char* target : {"/", "/index.html", "/?x=1"}) {
    const std::string answer = Get(target);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
    EXPECT_THAT(answer, EndsWith("\r\n\r\n<!DOCTYPE html><p>the page"));
    for (const char* field :
         {"Content-Type: text/html; charset=utf-8", "X-Content-Type-Options: nosniff",
          "Referrer-Policy: no-referrer", "Cache-Control: no-store", "Content-Length: 26",
          // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): one field of many words
          "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline' blob:; "
          "worker-src blob:; style-src 'unsafe-inline'; img-src blob: data:; "
          "connect-src 'self' ws://"}) {
      EXPECT_THAT(answer, HasSubstr("\r\n" + std::string(field)));
    }
    EXPECT_THAT(answer, HasSubstr("connect-src 'self' ws://" + host_ +
                                  "; font-src data:; base-uri 'none'; form-action 'none'; "
                                  "frame-ancestors 'none'\r\n"))
        << "no other server's WebSocket";
  }
}

TEST_F(ServerHttpTest, HeadHasNoBody) {
  const std::string answer = Exchange(port_, "HEAD / HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 26\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(ServerHttpTest, OtherPathsAreNotFound) {
  for (const char* target : {"/favicon.ico", "/../etc/passwd", "/index.htm", "*"}) {
    EXPECT_THAT(Get(target), StartsWith("HTTP/1.1 404 ")) << target;
  }
  EXPECT_THAT(Get("http://evil.example/"), StartsWith("HTTP/1.1 404 "));
}

TEST_F(ServerHttpTest, OtherMethodsAreNotAllowed) {
  const std::string body = std::string(100'000, 'x');
  const std::string answer = Exchange(
      port_, "POST / HTTP/1.1\r\nHost: " + host_ + "\r\nContent-Length: 100000\r\n\r\n" + body);
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(answer, HasSubstr("Allow: GET, HEAD\r\n"));
}

TEST_F(ServerHttpTest, ForeignHostIsRefused) {
  for (const std::string& host : std::vector<std::string>{
           std::string("evil.example"), "evil.example:" + std::to_string(port_),
           std::string("localhost:1"), std::string()}) {
    const std::string answer = Exchange(port_, GetRequest("/", host));
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 403 ")) << host;
    EXPECT_THAT(answer, HasSubstr("Open http://" + host_ + " instead."));
    EXPECT_THAT(answer, Not(HasSubstr("the page")));
  }
  EXPECT_THAT(Exchange(port_, "GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Get("/", "Host: evil.example\r\n"), StartsWith("HTTP/1.1 403 "));
}

TEST_F(ServerHttpTest, ForeignOriginIsRefused) {
  EXPECT_THAT(Upgrade(""), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Upgrade("Origin: null\r\n"), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Upgrade("Origin: http://evil.example\r\n"), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Upgrade("Origin: https://" + host_ + "\r\n"), StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Upgrade("Origin: http://" + host_ + "\r\nOrigin: http://evil.example\r\n"),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THROW(TestBrowser(port_, "http://evil.example"), boost::system::system_error);
  EXPECT_NO_THROW(TestBrowser(port_, "http://" + host_));
}

TEST_F(ServerHttpTest, ForeignHostIsRefusedForTheWebSocketToo) {
  const std::string host = "evil.example:" + std::to_string(port_);
  EXPECT_THAT(Exchange(port_, GetRequest("/ws", host,
                                         "Connection: Upgrade\r\nUpgrade: websocket\r\n"
                                         "Sec-WebSocket-Version: 13\r\n"
                                         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                                         "Origin: http://" +
                                             host + "\r\n")),
              StartsWith("HTTP/1.1 403 "));
}

TEST_F(ServerHttpTest, PlainRequestOfTheWebSocketIsAnswered) {
  EXPECT_THAT(Get("/ws"), StartsWith("HTTP/1.1 426 "));
}

TEST_F(ServerHttpTest, WhatIsNoHttpIsRefused) {
  EXPECT_THAT(Exchange(port_, "\x16\x03\x01 hello\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Get("/", "X: " + std::string(10'000, 'x') + "\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Get("/"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(ServerHttpTest, NothingComesBeforeTheUpgradesAnswer) {
  EXPECT_THAT(Upgrade("Origin: http://" + host_ + "\r\n\r\nfirst"), StartsWith("HTTP/1.1 400 "));
}

TEST_F(ServerHttpTest, RandomBytesAreRefused) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    std::string bytes(20 + random() % 200, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    EXPECT_THAT(Exchange(port_, "GET " + bytes + "\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  }
}

// Whoever holds connections open and says nothing keeps nobody out.
TEST_F(ServerHttpTest, AThousandSilentConnectionsKeepNobodyOut) {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 4096);  // most often 1024, of both ends here
  setrlimit(RLIMIT_NOFILE, &files);
  std::vector<std::unique_ptr<HeldConnection>> held;
  for (int i = 0; i < 1000; ++i) {
    held.push_back(std::make_unique<HeldConnection>(port_));
    if (i % 3 == 1) held.back()->Say("GET / HT");
    if (i % 3 == 2) held.back()->Say(GetRequest("/", host_));  // and reads no answer
    if (i % 100 == 99) {
      EXPECT_THAT(Get("/"), StartsWith("HTTP/1.1 200 "));
    }
  }
  TestBrowser browser(server_);
  EXPECT_EQ(browser.Hello().type(), "hello");
}

// A byte now and then does not make a request's time longer.
TEST_F(ServerHttpTest, ASlowRequestIsGivenUp) {
  HeldConnection slow(port_);
  slow.Say("GET / HTTP/1.1\r\n");
  const auto begin = std::chrono::steady_clock::now();
  while (slow.IsOpen()) {
    ASSERT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
    slow.Say("X");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

TEST_F(ServerHttpTest, BrowsersBeyond64AreToldSo) {
  std::vector<std::unique_ptr<TestBrowser>> browsers;
  for (int i = 0; i < 64; ++i) {
    browsers.push_back(std::make_unique<TestBrowser>(server_));
    browsers.back()->Hello();
  }
  for (int i = 0; i < 40; ++i) {  // the page shows the reason
    TestBrowser one_more(server_);
    EXPECT_EQ(one_more.CloseCode(), 1013);
    EXPECT_EQ(one_more.CloseReason(), "Too many browsers are connected; close one of them.");
  }
  EXPECT_EQ(server_.Browsers().size(), 64U);
  EXPECT_THAT(Get("/"), StartsWith("HTTP/1.1 200 "));
  browsers.pop_back();
  EXPECT_EQ(TestBrowser(server_).Hello().type(), "hello") << "there is room again";
}

// A flood of fragments of a byte each waits in the sender's own buffers.
TEST_F(ServerHttpTest, AFloodIsReadSlowly) {
  HeldConnection flood(port_);
  flood.Say(UpgradeRequest("Origin: http://" + host_ + "\r\n"));
  flood.Await("101 Switching");
  const std::string hello = R"({"type": "hello", "token": ""})";
  flood.Say(std::string("\x81") + static_cast<char>(0x80 + hello.size()) + std::string(4, '\0') +
            hello);
  std::string fragments("\x01\x81\0\0\0\0x", 7);
  while (fragments.size() < 100'000) fragments += std::string("\x00\x81\0\0\0\0x", 7);
  const auto begin = std::chrono::steady_clock::now();
  flood.Say(fragments + std::string("\x80\x81\0\0\0\0x", 7));  // the end: it is no JSON
  flood.Await("no JSON");                                      // in the close's reason
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4)) << "100 KB";
}

// Those that are told to go, and do not, are limited as well.
TEST_F(ServerHttpTest, WebSocketsBeyondThatAreRefused) {
  std::vector<std::unique_ptr<HeldConnection>> held;
  for (int i = 0; i < 96; ++i) {
    held.push_back(std::make_unique<HeldConnection>(port_));
    held.back()->Say(UpgradeRequest("Origin: http://" + host_ + "\r\n"));
    held.back()->Await("101 Switching");
  }
  const std::string answer = Upgrade("Origin: http://" + host_ + "\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 503 "));
  EXPECT_THAT(answer, HasSubstr("Too many browsers are connected; close one of them."));
}

TEST(ServerHttp, WithoutAPageSaysWhatToDo) {
  ServerOptions options;
  options.port = 0;
  const Server server(options, nullptr);
  const std::string host = "localhost:" + std::to_string(PortOf(server));
  EXPECT_THAT(Exchange(PortOf(server), GetRequest("/", host)), HasSubstr("nodejs and npm"));
}

TEST(ServerHttp, UrlCarriesTheToken) {
  ServerOptions options;
  options.port = 0;
  options.token = "s3cret";
  EXPECT_THAT(Server(options, nullptr).Url(), EndsWith("/#token=s3cret"));
}

}  // namespace
}  // namespace rgbdt::viewer
