#include "services/bus/signed_bus.h"

#include <gmock/gmock.h>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "services/messages/limits.h"
#include "tests/unit/bus/bus_key.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Bytes Command(const std::string& view) {
  SessionCommand command;
  command.verb = SessionVerb::kSweep;
  command.view = view;
  return Encode(command);
}

class SignedBusTest : public ::testing::Test {
 protected:
  SignedBusTest() {
    wire_.Subscribe(".*",
                    [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                      recorded_.emplace_back(channel, Bytes(data, data + size));
                    });
    receiver_.Subscribe("SESSION_COMMAND|ENCODER", [&](const std::string& channel,
                                                       const std::uint8_t* data, std::size_t size) {
      const Message message = Decode(channel, data, size);
      const auto* command = std::get_if<SessionCommand>(&message);
      got_.push_back(command == nullptr ? channel : command->view);
    });
  }

  Utime now_ = 1'700'000'000'000'000;
  MemoryBus wire_;
  SignedBus sender_{&wire_, KeyOf(1), [this] { return now_; }};
  SignedBus receiver_{&wire_, KeyOf(1), [this] { return now_; }};
  std::vector<std::pair<std::string, Bytes>> recorded_;
  std::vector<std::string> got_;
};

TEST_F(SignedBusTest, CommandsOfWhoHasTheKeyAreTaken) {
  sender_.Publish("SESSION_COMMAND", Command("0001"));
  wire_.Run();
  EXPECT_THAT(got_, ElementsAre("0001"));
  EXPECT_EQ(receiver_.refused().count, 0);
  ASSERT_EQ(recorded_.size(), 1U);
  EXPECT_EQ(recorded_[0].second.size(), Command("0001").size() + kSignatureBytes);
}

TEST_F(SignedBusTest, UnsignedCommandsAreIgnoredCountedAndNamed) {
  wire_.Publish("SESSION_COMMAND", Command("0001"));
  wire_.Run();
  EXPECT_TRUE(got_.empty());
  EXPECT_EQ(receiver_.refused().count, 1);
  EXPECT_THAT(receiver_.refused().newest, HasSubstr("SESSION_COMMAND is not signed"));
}

TEST_F(SignedBusTest, ARecordingPlayedAgainIsIgnored) {
  sender_.Publish("SESSION_COMMAND", Command("0001"));
  wire_.Run();
  const auto log = recorded_;
  for (const auto& [channel, bytes] : log) wire_.Publish(channel, bytes);
  wire_.Run();
  EXPECT_THAT(got_, ElementsAre("0001")) << "at once";
  now_ += 60 * kMicrosecondsPerSecond;
  for (const auto& [channel, bytes] : log) wire_.Publish(channel, bytes);
  wire_.Run();
  EXPECT_THAT(got_, ElementsAre("0001")) << "a minute later";
  EXPECT_EQ(receiver_.refused().count, 2);
  EXPECT_THAT(receiver_.refused().newest, HasSubstr("a recording"));
}

TEST_F(SignedBusTest, WhoHasNoKeyTakesThem) {
  std::vector<std::string> views;
  wire_.Subscribe("SESSION_COMMAND",
                  [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                    views.push_back(std::get<SessionCommand>(Decode(channel, data, size)).view);
                  });
  sender_.Publish("SESSION_COMMAND", Command("0007"));
  wire_.Run();
  EXPECT_THAT(views, ElementsAre("0007"));
}

TEST_F(SignedBusTest, WhatSensorsSayPassesAsItIs) {
  const Bytes reading = Encode(EncoderReading{1, 0, 0, 0});
  sender_.Publish("ENCODER", reading);
  wire_.Publish("ENCODER", reading);
  wire_.Run();
  EXPECT_THAT(got_, ElementsAre("ENCODER", "ENCODER"));
  for (const auto& [channel, bytes] : recorded_) EXPECT_EQ(bytes, reading);
}

TEST_F(SignedBusTest, EachSubscriberGetsAMessageOnce) {
  int second = 0;
  receiver_.Subscribe("SESSION_.*", [&](const std::string&, const std::uint8_t*, std::size_t size) {
    ++second;
    EXPECT_EQ(size, Command("0001").size());
  });
  sender_.Publish("SESSION_COMMAND", Command("0001"));
  wire_.Run();
  EXPECT_EQ(got_.size(), 1U);
  EXPECT_EQ(second, 1);
}

// A process that computes for a minute still takes what waited for it meanwhile.
TEST(SignedBusArrival, WaitingForAHandlerMakesNoMessageOld) {
  class LateBus : public MemoryBus {
   public:
    Utime arrived() const override { return when; }
    Utime when = 0;
  };
  constexpr Utime kSent = 1'700'000'000'000'000;
  LateBus wire;
  Utime now = kSent;
  SignedBus bus(&wire, KeyOf(1), [&] { return now; });
  int got = 0;
  bus.Subscribe("RIG", [&](const std::string&, const std::uint8_t*, std::size_t) { ++got; });
  bus.Publish("RIG", {1});
  bus.Publish("RIG", {2});
  now += 60 * kMicrosecondsPerSecond;
  wire.when = kSent + 1;
  wire.Run();
  EXPECT_EQ(got, 2);
}

TEST(SignedBusSize, WhatHasNoRoomForASignatureIsNotSent) {
  MemoryBus wire;
  SignedBus bus(&wire, KeyOf(1), [] { return Utime{1}; });
  EXPECT_THROW(bus.Publish("RIG", Bytes(kMaxMessageBytes - kSignatureBytes + 1)), InputError);
  EXPECT_NO_THROW(bus.Publish("RIG", Bytes(kMaxMessageBytes - kSignatureBytes)));
}

}  // namespace
}  // namespace rgbdt
