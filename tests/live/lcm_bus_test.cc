#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>

#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "services/runtime/node_runner.h"
#include "tests/datagrams.h"

// Runs in a network namespace of its own with a multicast route (scripts/in-namespace). Waits for
// what is to happen, up to a limit that only a failure meets.

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPatience = std::chrono::seconds(30);

/// Of the bus that LCM_DEFAULT_URL names.
int Port() {
  const std::string url = CompleteUrl("");
  const std::size_t colon = url.find(':', std::string("udpm://").size());
  return colon == std::string::npos ? 7667 : std::stoi(url.substr(colon + 1));
}

/// Runs the bus until `done`; false after 30 s.
bool RunUntil(LcmBus* bus, const std::function<bool()>& done) {
  const Clock::time_point end = Clock::now() + kPatience;
  while (!done()) {
    if (Clock::now() > end) return false;
    bus->Run(20);
  }
  return true;
}

/// A message that says in every byte which one it is.
Bytes Numbered(int number, std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 31 + static_cast<std::size_t>(number));
  }
  return bytes;
}

class LcmBusTest : public ::testing::Test {
 protected:
  LcmBus sender_{""};
  LcmBus receiver_{""};
};

// As fast as the kernel's buffer allows: all at once where it has the 32 MiB that set-up asks for,
// else each when the one before has arrived.
TEST_F(LcmBusTest, LargeMessagesArriveWholeAndInOrder) {
  constexpr int kMessages = 40;
  const bool small_buffer = !ReceiveBufferAdvice().empty();
  const int ahead = small_buffer ? 1 : 5;
  int received = 0;
  receiver_.Subscribe(
      "LARGE", [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        EXPECT_EQ(channel, "LARGE");
        EXPECT_EQ(Bytes(data, data + size), Numbered(received, 2'900'000)) << received;
        ++received;
      });
  for (int sent = 0; sent < kMessages; ++sent) {
    sender_.Publish("LARGE", Numbered(sent, 2'900'000));
    ASSERT_TRUE(RunUntil(&receiver_, [&] { return received > sent - ahead; }))
        << "lost " << received;
  }
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return received == kMessages; }));
}

TEST_F(LcmBusTest, ManySmallMessagesWaitWhileTheReceiverComputes) {
  constexpr int kMessages = 2000;
  int received = 0;
  receiver_.Subscribe("SMALL", [&](const std::string&, const std::uint8_t* data, std::size_t size) {
    EXPECT_EQ(Bytes(data, data + size), Numbered(received, 500));
    ++received;
  });
  for (int sent = 0; sent < kMessages; ++sent) sender_.Publish("SMALL", Numbered(sent, 500));
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return received == kMessages; })) << received;
}

TEST_F(LcmBusTest, HandlersThatThrowDoNotEndTheBus) {
  int received = 0;
  receiver_.Subscribe("A", [&](const std::string&, const std::uint8_t* data, std::size_t) {
    ++received;
    if (data[0] == 0) throw std::runtime_error("zero");
    if (data[0] == 1) throw 1;
  });
  for (std::uint8_t i = 0; i < 4; ++i) sender_.Publish("A", Bytes{i});
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return received == 4; }));
  EXPECT_EQ(receiver_.handler_failures(), 2);
}

TEST_F(LcmBusTest, ExpressionsMatchTheWholeName) {
  std::vector<std::string> heard;
  receiver_.Subscribe("A|B", [&](const std::string& channel, const std::uint8_t*, std::size_t) {
    heard.push_back(channel);
  });
  for (const char* channel : {"A2", "2B", "A", "AB", "B"}) sender_.Publish(channel, Bytes{1});
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return !heard.empty() && heard.back() == "B"; }));
  EXPECT_THAT(heard, ::testing::ElementsAre("A", "B"));
  EXPECT_THROW(receiver_.Subscribe("(", {}), InputError);
}

void SendDatagram(const Bytes& bytes, const char* address = "239.255.76.67") {
  static const int udp =
      socket(AF_INET, SOCK_DGRAM, 0);  // one sender, whose fragments belong together
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(Port()));
  inet_pton(AF_INET, address, &to.sin_addr);
  EXPECT_EQ(
      sendto(udp, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
      static_cast<ssize_t>(bytes.size()));
}

class CountingNode : public Node {
 public:
  std::string name() const override { return "counting"; }
  std::vector<std::string> Subscriptions() const override { return {"ENCODER", "STATUS"}; }
  Messages Handle(const Message& message) override {
    handled += std::holds_alternative<EncoderReading>(message) ? 1 : 0;
    return {};
  }
  Status GetStatus() const override { return {}; }
  int handled = 0;
};

// Rubbish as datagrams below LCM, and as messages on a node's channels.
TEST_F(LcmBusTest, GarbageIsSurvivedAndCounted) {
  CountingNode node;
  NodeRunner runner(&node, &receiver_);
  SendDatagram({});
  for (const char* magic : {"LC02", "LC03", "XXXX"}) {
    for (const std::size_t size : {4U, 8U, 9U, 20U, 200U}) {
      Bytes bytes = Numbered(7, size);
      std::copy(magic, magic + 4, bytes.begin());
      SendDatagram(bytes);
    }
  }
  for (int i = 0; i < 50; ++i) {
    sender_.Publish("ENCODER", Numbered(i, static_cast<std::size_t>(i)));
    sender_.Publish("STATUS", Numbered(i, 1000));
  }
  sender_.Publish("ENCODER", Encode(EncoderReading{1, 0, 0, 0}));
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return node.handled == 1; }));
  EXPECT_EQ(runner.dropped(), 100);
  EXPECT_GE(receiver_.malformed().count, 9);  // empty, XXXX, and fragments without a header
  runner.Advance(1);
  const Status status = runner.GetStatus();
  EXPECT_EQ(status.last_problem.substr(0, 26), "a malformed datagram from ");
  EXPECT_THAT(status.counters, ::testing::Contains(std::make_pair(std::string("malformed"),
                                                                  receiver_.malformed().count)));
}

// Each of them, and between them messages, which arrive whole.
TEST_F(LcmBusTest, MalformedDatagramsAreCountedAndNamed) {
  int received = 0;
  receiver_.Subscribe("A", [&](const std::string&, const std::uint8_t* data, std::size_t size) {
    EXPECT_EQ(Bytes(data, data + size), size > 200 ? Numbered(received, 200'000) : Bytes(100, 7));
    received += size > 200 ? 1 : 0;
  });
  std::int64_t sent = 0;
  for (const test::Attack& attack : test::Attacks("A")) {
    for (const Bytes& datagram : attack.datagrams) SendDatagram(datagram);
    sender_.Publish("A", Numbered(static_cast<int>(sent++), 200'000));
    ASSERT_TRUE(RunUntil(&receiver_, [&] { return received == sent; })) << attack.why;
    EXPECT_EQ(receiver_.malformed().count, sent) << attack.why;
    EXPECT_THAT(receiver_.malformed().newest, ::testing::HasSubstr(attack.why));
  }
}

TEST_F(LcmBusTest, WhatIsSentToTheMachineAndNotToTheGroupIsNotHeard) {
  int received = 0;
  receiver_.Subscribe("A",
                      [&](const std::string&, const std::uint8_t*, std::size_t) { ++received; });
  for (const test::Attack& attack : test::Attacks("A")) {
    for (const Bytes& datagram : attack.datagrams) SendDatagram(datagram, "127.0.0.1");
  }
  SendDatagram(test::ShortDatagram(1, std::string("A\0", 2), {1}), "127.0.0.1");
  sender_.Publish("A", Bytes{1});
  EXPECT_TRUE(RunUntil(&receiver_, [&] { return received > 0; }));
  EXPECT_EQ(received, 1);
  EXPECT_EQ(receiver_.malformed().count, 0);
}

TEST_F(LcmBusTest, PublishingWhatLcmCannotCarryThrows) {
  EXPECT_THROW(sender_.Publish(std::string(64, 'A'), Bytes{1}), InputError);
}

TEST_F(LcmBusTest, RunComesBackWhenNothingComes) { EXPECT_FALSE(receiver_.Run(1)); }

}  // namespace
}  // namespace rgbdt
