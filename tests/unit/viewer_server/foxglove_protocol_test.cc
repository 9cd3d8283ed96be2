#include "viewer/server/internal/foxglove_protocol.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "viewer/server/internal/message.h"

namespace rgbdt::viewer {
namespace {

using nlohmann::json;

TEST(FoxgloveProtocol, TheFirstSubprotocolThatIsSpokenIsChosen) {
  EXPECT_EQ(FoxgloveSubprotocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(FoxgloveSubprotocol("foxglove.sdk.v2, foxglove.sdk.v1,foxglove.websocket.v1"),
            "foxglove.sdk.v1");
  for (const char* other : {"", "foxglove.websocket.v2", "chat", ",,;"}) {
    EXPECT_EQ(FoxgloveSubprotocol(other), "") << other;
  }
}

TEST(FoxgloveProtocol, ChannelsAreDescribedAsTheSpecificationSays) {
  Channel channel;
  channel.id = 7;
  channel.topic = "/fused/points";
  channel.schema_name = "foxglove.PointCloud";
  for (const auto& [bytes, base64] : {std::pair<std::string, std::string>{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {std::string("\xff\xfe\0", 3), "//4A"}}) {
    channel.schema = std::make_shared<const std::string>(bytes);
    EXPECT_EQ(json::parse(AdvertiseText({&channel})),
              json({{"op", "advertise"},
                    {"channels",
                     {{{"id", 7},
                       {"topic", "/fused/points"},
                       {"encoding", "protobuf"},
                       {"schemaName", "foxglove.PointCloud"},
                       {"schema", base64},
                       {"schemaEncoding", "protobuf"}}}}}));
  }
  EXPECT_EQ(json::parse(AdvertiseText({})), json::parse(R"({"op":"advertise","channels":[]})"));
  EXPECT_EQ(json::parse(ServerInfoText("rgbdt")),
            json::parse(R"({"op":"serverInfo","name":"rgbdt","capabilities":[]})"));
  EXPECT_EQ(json::parse(UnadvertiseText({3, 4})),
            json::parse(R"({"op":"unadvertise","channelIds":[3,4]})"));
}

TEST(FoxgloveProtocol, NamesThatAreNoUtf8StayWellFormed) {
  Channel channel;
  channel.topic = "/\xff/image_raw";
  channel.schema = std::make_shared<const std::string>();
  EXPECT_NO_THROW(json::parse(AdvertiseText({&channel})));
  EXPECT_NO_THROW(json::parse(WarningText("\xff")));
}

TEST(FoxgloveProtocol, BeforeAMessageStandSubscriptionAndNanoseconds) {
  EXPECT_EQ(MessageHead(0x01020304, 1'700'000'000'000'001),  // ns: 0x17979cfe362a03e8
            std::string("\x01\x04\x03\x02\x01\xe8\x03\x2a\x36\xfe\x9c\x97\x17", 13));
}

TEST(FoxgloveProtocol, RequestsAreRead) {
  const auto subscribe = ParseFoxgloveRequest(
      R"({"op":"subscribe","new":1,"subscriptions":[{"id":0,"channelId":3,"more":{}},)"
      R"({"id":4294967295,"channelId":5}]})");
  EXPECT_EQ(subscribe.kind, FoxgloveRequest::Kind::kSubscribe);
  ASSERT_EQ(subscribe.subscriptions.size(), 2U);
  EXPECT_EQ(subscribe.subscriptions[0].channel, 3U);
  EXPECT_EQ(subscribe.subscriptions[1].id, 4294967295U);
  const auto unsubscribe = ParseFoxgloveRequest(R"({"op":"unsubscribe","subscriptionIds":[0,9]})");
  EXPECT_EQ(unsubscribe.kind, FoxgloveRequest::Kind::kUnsubscribe);
  EXPECT_THAT(unsubscribe.ids, testing::ElementsAre(0U, 9U));
  EXPECT_EQ(ParseFoxgloveRequest(R"({"op":"getParameters"})").kind, FoxgloveRequest::Kind::kOther);
}

TEST(FoxgloveProtocol, WhatMakesNoSenseIsRefused) {
  for (const char* text :
       {"", "{", "[]", "1", "{}", R"({"op":1})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":{}})", R"({"op":"subscribe","subscriptions":[1]})",
        R"({"op":"subscribe","subscriptions":[{"id":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})"}) {
    EXPECT_THROW(ParseFoxgloveRequest(text), MalformedMessage) << text;
  }
  EXPECT_THROW(ParseFoxgloveRequest(R"({"op":")" + std::string(300, 'x') + "\"}"),
               MalformedMessage);
  std::string many = R"({"op":"unsubscribe","subscriptionIds":[1)";
  for (int i = 0; i < 1000; ++i) many += ",1";
  EXPECT_THROW(ParseFoxgloveRequest(many + "]}"), MalformedMessage);
}

}  // namespace
}  // namespace rgbdt::viewer
