#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "test_browser.h"
#include "viewer/server/server.h"

namespace rgbdt::viewer {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr char kV1[] = "foxglove.websocket.v1";
constexpr int kPolicy = 1008;

class ServerFoxgloveTest : public ::testing::Test {
 protected:
  static ServerOptions Options(const std::string& token = "") {
    ServerOptions options;
    options.port = 0;
    options.page = "the page";
    options.token = token;
    options.foxglove_origins = {"https://app.foxglove.dev", "file://"};
    return options;
  }
  TestBrowser Connect() { return TestBrowser(port_, {"none", "/", kV1}); }
  void Publish(const std::string& topic, const std::string& bytes, bool large = false,
               const std::string& holds_for = "") {
    ChannelMessage message;
    message.topic = topic;
    message.schema_name = "test.Text";
    message.schema = std::make_shared<const std::string>("schema");
    message.utime = 1;
    message.large = large;
    message.holds_for = holds_for;
    message.make = [bytes] { return bytes; };
    server_.Publish(std::move(message));
  }
  // Reads the greeting; the channels by topic.
  static std::map<std::string, std::uint32_t> Greeted(TestBrowser* client) {
    EXPECT_EQ(client->NextMessage().Json()["op"], "serverInfo");
    const json advertised = client->NextMessage().Json();
    EXPECT_EQ(advertised["op"], "advertise");
    std::map<std::string, std::uint32_t> ids;
    for (const json& channel : advertised["channels"]) ids[channel["topic"]] = channel["id"];
    return ids;
  }
  static void Subscribe(TestBrowser* client, std::uint32_t id, std::uint32_t channel) {
    client->Say({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}});
  }
  // Returns once the server heard it.
  static void SubscribeNow(TestBrowser* client, std::uint32_t id, std::uint32_t channel) {
    Subscribe(client, id, channel);
    Subscribe(client, 1000, 77);
    ASSERT_THAT(client->NextMessage().bytes, HasSubstr("there is no channel 77"));
  }
  // A message of subscription `id` with those bytes.
  static std::string Framed(std::uint8_t id, const std::string& bytes) {
    return std::string("\x01", 1) + static_cast<char>(id) +
           std::string("\0\0\0\xe8\x03\0\0\0\0\0\0", 11) + bytes;
  }
  std::string Answer(const std::string& fields, const std::string& target = "/") const {
    return Exchange(port_, GetRequest(target, host_,
                                      "Connection: Upgrade\r\nUpgrade: websocket\r\n"
                                      "Sec-WebSocket-Version: 13\r\n"
                                      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
                                          fields));
  }

  Server server_{Options(), nullptr};
  int port_ = PortOf(server_);
  std::string host_ = "127.0.0.1:" + std::to_string(port_);
};

TEST_F(ServerFoxgloveTest, WhatIsPublishedComesToWhoSubscribed) {
  Publish("/log", "before");
  TestBrowser client = Connect();
  EXPECT_EQ(client.subprotocol(), kV1);
  auto channels = Greeted(&client);
  ASSERT_EQ(channels.count("/log"), 1U);
  SubscribeNow(&client, 9, channels["/log"]);
  Publish("/other", "not subscribed");  // its channel is told
  const json more = client.NextMessage().Json();
  EXPECT_EQ(more["channels"][0]["topic"], "/other");
  EXPECT_EQ(more["channels"][0]["schema"], "c2NoZW1h");
  for (const char* bytes : {"one", "two", "three"}) Publish("/log", bytes);
  for (const char* bytes : {"one", "two", "three"}) {
    const GotMessage got = client.NextMessage();
    EXPECT_FALSE(got.is_text);
    EXPECT_EQ(got.bytes, Framed(9, bytes));
  }
  client.Say({{"op", "unsubscribe"}, {"subscriptionIds", {9}}});
  SubscribeNow(&client, 4, channels["/log"]);
  Publish("/log", "four");
  EXPECT_EQ(client.NextMessage().bytes, Framed(4, "four"));
}

TEST_F(ServerFoxgloveTest, WhatHoldsComesToWhoSubscribesLater) {
  Publish("/tf_static", "guess", false, "rgb");
  Publish("/tf_static", "solved", false, "rgb");
  Publish("/tf_static", "thermal", false, "thermal");
  Publish("/log", "passing");
  TestBrowser client = Connect();
  auto channels = Greeted(&client);
  Subscribe(&client, 0, channels["/log"]);
  Subscribe(&client, 1, channels["/tf_static"]);
  EXPECT_EQ(client.NextMessage().bytes, Framed(1, "solved"));
  EXPECT_EQ(client.NextMessage().bytes, Framed(1, "thermal"));
}

TEST_F(ServerFoxgloveTest, ChannelsEndAndBeginAnew) {
  Publish("/tf_static", "old", false, "rgb");
  TestBrowser client = Connect();
  auto channels = Greeted(&client);
  Subscribe(&client, 1, channels["/tf_static"]);
  EXPECT_EQ(client.NextMessage().bytes, Framed(1, "old"));
  server_.EndChannels();
  Publish("/tf_static", "new", false, "rgb");
  EXPECT_EQ(client.NextMessage().Json(),
            json({{"op", "unadvertise"}, {"channelIds", {channels["/tf_static"]}}}));
  const json again = client.NextMessage().Json();
  EXPECT_NE(again["channels"][0]["id"], channels["/tf_static"]);
  Subscribe(&client, 1, again["channels"][0]["id"]);
  EXPECT_EQ(client.NextMessage().bytes, Framed(1, "new"));
}

// A megabyte a message: more than the sockets hold.
TEST_F(ServerFoxgloveTest, WhoReadsNothingLosesWholeMessagesAndHoldsUpNobody) {
  Publish("/points", "", true);
  TestBrowser stalled = Connect(), reading = Connect();
  const std::uint32_t channel = Greeted(&stalled)["/points"];
  Greeted(&reading);
  for (TestBrowser* client : {&stalled, &reading}) {
    SubscribeNow(client, 1, channel);
  }
  constexpr int kMessages = 16;
  const auto cloud = [](int i) { return std::string(1'000'000, static_cast<char>('A' + i)); };
  for (int i = 0; i < kMessages; ++i) {
    Publish("/points", cloud(i), true);
    EXPECT_EQ(reading.NextMessage().bytes, Framed(1, cloud(i)));
  }
  const auto states = server_.Browsers();
  ASSERT_EQ(states.size(), 2U);
  EXPECT_GT(states[0].thinned, kMessages / 2);
  EXPECT_EQ(states[1].thinned, 0);
  int came = 0;
  while (true) {
    const std::string bytes = stalled.NextMessage().bytes;
    ASSERT_EQ(bytes.size(), 13U + 1'000'000U) << "whole, or not at all";
    ++came;
    if (bytes.back() == static_cast<char>('A' + kMessages - 1)) break;  // the newest comes
  }
  EXPECT_LT(came, kMessages / 2);
}

TEST_F(ServerFoxgloveTest, WhatIsAskedForBeyondLookingIsAWarning) {
  TestBrowser client = Connect();
  Greeted(&client);
  client.Say({{"op", "advertise"}, {"channels", json::array()}});
  const json warning = client.NextMessage().Json();
  EXPECT_EQ(warning["op"], "status");
  EXPECT_EQ(warning["level"], 1);
  EXPECT_THAT(warning["message"].get<std::string>(), HasSubstr("\"advertise\""));
  client.Say({{"op", "unsubscribe"}, {"subscriptionIds", {3}}});  // of nothing: nothing
  client.Say({{"op", "getParameters"}});
  EXPECT_THAT(client.NextMessage().bytes, HasSubstr("getParameters"));
}

TEST_F(ServerFoxgloveTest, MalformedMessagesEndTheirConnectionAlone) {
  Publish("/log", "x");
  TestBrowser bystander = Connect();
  auto channels = Greeted(&bystander);
  SubscribeNow(&bystander, 1, channels["/log"]);
  const auto code = [&](const std::string& text, bool binary = false) {
    TestBrowser client = Connect();
    client.SayText(text, binary);
    return client.CloseCode();
  };
  EXPECT_EQ(code("{"), 1007);
  EXPECT_EQ(code("[]"), kPolicy);
  EXPECT_EQ(code(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"), kPolicy);
  EXPECT_EQ(code(std::string("\x01\x01\0\0\0payload", 12), true), kPolicy)
      << "it publishes nothing";
  EXPECT_EQ(code(std::string(65 * 1024, ' ')), 1009);
  Publish("/log", "still there");
  EXPECT_EQ(bystander.NextMessage().bytes, Framed(1, "still there"));
}

TEST_F(ServerFoxgloveTest, WhoMayConnect) {
  const std::string offer = std::string("Sec-WebSocket-Protocol: ") + kV1 + "\r\n";
  for (const std::string origin : {"none", "https://app.foxglove.dev", "file://"}) {
    EXPECT_NO_THROW(TestBrowser(port_, {origin, "/", kV1})) << origin;
  }
  EXPECT_NO_THROW(TestBrowser(port_, {"", "/", kV1})) << "this server's own page";
  EXPECT_EQ(TestBrowser(port_, {"none", "/?x", "foxglove.sdk.v1"}).subprotocol(),
            "foxglove.sdk.v1");
  for (const std::string origin : {"https://evil.example", "http://app.foxglove.dev", "null", "",
                                   "https://app.foxglove.dev.evil.example"}) {
    EXPECT_THAT(Answer(offer + "Origin: " + origin + "\r\n"), StartsWith("HTTP/1.1 403 "))
        << origin;
    EXPECT_THAT(Answer(offer + "Origin: " + origin + "\r\n", "/?token="),
                StartsWith("HTTP/1.1 403 "))
        << origin << ": there is no token";
  }
  EXPECT_THAT(Answer(offer + "Origin: file://\r\nOrigin: https://evil.example\r\n"),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(Answer("Sec-WebSocket-Protocol: chat\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Answer(""), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Answer(offer, "/other"), StartsWith("HTTP/1.1 404 "));
  EXPECT_THAT(Answer(offer, "/ws"), StartsWith("HTTP/1.1 403 ")) << "the page's, without an Origin";
  EXPECT_THAT(Answer(offer + "Host: evil.example\r\n"), StartsWith("HTTP/1.1 403 "));
}

TEST_F(ServerFoxgloveTest, TheTokenOpensItToOtherPages) {
  const Server guarded(Options("s3cret"), nullptr);
  const int port = PortOf(guarded);
  EXPECT_EQ(guarded.FoxgloveUrl(), "ws://127.0.0.1:" + std::to_string(port) + "/?token=s3cret");
  EXPECT_EQ(server_.FoxgloveUrl(), "ws://" + host_);
  const std::string evil = "https://elsewhere.example";
  EXPECT_NO_THROW(TestBrowser(port, {evil, "/?a=b&token=s3cret", kV1}));
  EXPECT_NO_THROW(TestBrowser(port, {"none", "/", kV1})) << "to look needs no token";
  for (const char* target : {"/", "/?token=", "/?token=s3cre", "/?token=s3crets", "/?atoken=s3cret",
                             "/?token=s3cret&x"}) {
    if (std::string(target).back() == 'x') {
      EXPECT_NO_THROW(TestBrowser(port, {evil, target, kV1}));
    } else {
      EXPECT_THROW(TestBrowser(port, {evil, target, kV1}), boost::system::system_error) << target;
    }
  }
}

TEST_F(ServerFoxgloveTest, ClientsTakePlacesAsBrowsersDo) {
  EXPECT_FALSE(server_.AnybodyListens());
  std::vector<std::unique_ptr<TestBrowser>> clients;
  for (int i = 0; i < 64; ++i) {
    clients.push_back(std::make_unique<TestBrowser>(port_, Handshake{"none", "/", kV1}));
    Greeted(clients.back().get());
  }
  EXPECT_TRUE(server_.AnybodyListens());
  EXPECT_EQ(server_.Browsers().size(), 64U);
  TestBrowser one_more = Connect();
  EXPECT_EQ(one_more.CloseCode(), 1013);
  EXPECT_EQ(TestBrowser(server_).CloseCode(), 1013) << "the page, too";
}

TEST(ServerFoxglove, OriginsAreChecked) {
  for (const char* origin : {"", "app.foxglove.dev", "https://app.foxglove.dev/", "://x", "*",
                             "https://*.foxglove.dev", "https://a b"}) {
    ServerOptions options;
    options.foxglove_origins = {origin};
    EXPECT_THROW(options.Check(), InputError) << origin;
  }
}

}  // namespace
}  // namespace rgbdt::viewer
