#include "viewer/server/internal/message.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace rgbdt::viewer {
namespace {

const std::vector<std::string> kGood = {
    R"({"type":"hello","token":""})",
    R"({"type":"watch","cloud":true,"cameras":["rgb","ir"],"overlay_cloud":false,"points":1})",
    R"({"type":"watch","cloud":false,"cameras":[],"overlay_cloud":true,"points":10000000})",
    R"({"type":"ack","id":4294967295})",
    R"({"type":"view","view":"0001"})",
    R"({"type":"leave_out","views":["0001","0004"]})",
    R"({"type":"leave_out","views":[]})",
    R"({"type":"request","request":"next_pose","heldout":false})",
    R"({"type":"request","request":"pose_is_set","heldout":false})",
    R"({"type":"request","request":"capture","heldout":true})",
    R"({"type":"request","request":"finish","heldout":false})",
    R"({"type":"pick","camera":"rgb","image_utime":1700000000000000,
        "corners":[[0,1.5],[-2,3],[1e3,4],[5,6]]})"};

TEST(Message, WhatThePageSaysIsTaken) {
  for (const std::string& text : kGood) {
    SCOPED_TRACE(text);
    EXPECT_EQ(ParseMessage(text), nlohmann::json::parse(text));
  }
}

// True: refused, and told apart by whether it is JSON at all.
bool RefusedAs(bool is_json, const std::string& text) {
  try {
    ParseMessage(text);
    return false;
  } catch (const MalformedMessage& error) {
    return error.is_json() == is_json && std::string(error.what()).size() <= 100;
  }
}

TEST(Message, NoJsonIsRefused) {
  for (const std::string text :
       {"", " ", "{", "hello", R"({"type":"ack","id":})", R"({"type":"ack","id":1}x)",
        R"({"type":"ack","id":1e999})", R"({"type":"ack","id":NaN})", "{\"type\":\"view\"\x01}",
        "{\"type\":\"view\",\"view\":\"\xff\"}", R"({'type':'ack','id':1})"}) {
    EXPECT_TRUE(RefusedAs(false, text)) << text;
  }
  EXPECT_TRUE(RefusedAs(false, std::string(60'000, '[')));
}

TEST(Message, AnotherFormIsRefused) {
  const std::string long_name(201, 'x');
  for (const std::string& text :
       std::vector<std::string>{"null",
                                "1",
                                "[]",
                                "\"hello\"",
                                "{}",
                                R"({"type":1})",
                                R"({"type":"reboot"})",
                                R"({"type":"hello"})",
                                R"({"type":"hello","token":null})",
                                R"({"type":"hello","token":")" + long_name + R"("})",
                                R"({"type":"hello","token":"","more":1})",
                                R"({"type":"ack"})",
                                R"({"type":"ack","id":0})",
                                R"({"type":"ack","id":-1})",
                                R"({"type":"ack","id":1.5})",
                                R"({"type":"ack","id":4294967296})",
                                R"({"type":"ack","id":18446744073709551615})",
                                R"({"type":"ack","id":"1"})",
                                R"({"type":"view","view":["0001"]})",
                                R"({"type":"request","request":"reboot","heldout":false})",
                                R"({"type":"request","request":"finish","heldout":0})",
                                R"({"type":"request","request":"finish"})"}) {
    EXPECT_TRUE(RefusedAs(true, text)) << text;
  }
}

TEST(Message, WatchOutOfRangeIsRefused) {
  nlohmann::json watch = nlohmann::json::parse(kGood[1]);
  const auto refused_with = [&](const char* field, const nlohmann::json& value) {
    nlohmann::json changed = watch;
    changed[field] = value;
    return RefusedAs(true, changed.dump());
  };
  EXPECT_TRUE(refused_with("points", 0));
  EXPECT_TRUE(refused_with("points", 10'000'001));
  EXPECT_TRUE(refused_with("points", 5.0));
  EXPECT_TRUE(refused_with("cloud", "yes"));
  EXPECT_TRUE(refused_with("cameras", "rgb"));
  EXPECT_TRUE(refused_with("cameras", {"rgb", 1}));
  EXPECT_TRUE(refused_with("cameras", {""}));
  EXPECT_TRUE(refused_with("cameras", std::vector<std::string>(65, "rgb")));
  EXPECT_FALSE(refused_with("cameras", std::vector<std::string>(64, "rgb")));
}

TEST(Message, ViewsToLeaveOutAreNames) {
  const auto refused_with = [&](const nlohmann::json& views) {
    return RefusedAs(true, nlohmann::json{{"type", "leave_out"}, {"views", views}}.dump());
  };
  EXPECT_TRUE(refused_with("0001"));
  EXPECT_TRUE(refused_with({"0001", 2}));
  EXPECT_TRUE(refused_with({""}));
  EXPECT_TRUE(refused_with(std::vector<std::string>(1001, "0001")));
  EXPECT_FALSE(refused_with(std::vector<std::string>(1000, "0001")));
}

TEST(Message, CornersOfAnotherFormAreRefused) {
  const nlohmann::json pick = nlohmann::json::parse(kGood.back());
  const auto refused_with = [&](const char* field, const nlohmann::json& value) {
    nlohmann::json changed = pick;
    changed[field] = value;
    return RefusedAs(true, changed.dump());
  };
  const auto pixels = [](std::size_t count, std::size_t numbers) {
    return std::vector<std::vector<double>>(count, std::vector<double>(numbers, 1.5));
  };
  EXPECT_FALSE(refused_with("corners", pixels(4, 2)));
  EXPECT_TRUE(refused_with("corners", pixels(3, 2)));
  EXPECT_TRUE(refused_with("corners", pixels(5, 2)));
  EXPECT_TRUE(refused_with("corners", pixels(4, 3)));
  EXPECT_TRUE(refused_with("corners", {1, 2, 3, 4}));
  EXPECT_TRUE(refused_with("corners", nlohmann::json::parse("[[1,null],[1,1],[1,1],[1,1]]")));
  EXPECT_TRUE(refused_with("image_utime", -1));
  EXPECT_TRUE(refused_with("image_utime", 1e15));
  EXPECT_TRUE(refused_with("image_utime", std::int64_t{1} << 54));
  EXPECT_TRUE(refused_with("camera", ""));
}

// Whatever comes, it is a message or a MalformedMessage.
TEST(Message, NothingElseIsThrown) {
  std::mt19937 random(7);
  int refused = 0;
  constexpr int kTries = 20'000;
  for (int i = 0; i < kTries; ++i) {
    std::string text = kGood[random() % kGood.size()];
    for (std::size_t change = 1 + random() % 4; change > 0; --change) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    try {
      ParseMessage(text);
    } catch (const MalformedMessage&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kTries / 2);
}

}  // namespace
}  // namespace rgbdt::viewer
