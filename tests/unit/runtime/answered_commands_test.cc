#include "services/runtime/answered_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "services/runtime/node_runner.h"

namespace rgbdt {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

SessionCommand Command(std::int64_t number, SessionVerb verb = SessionVerb::kSweep) {
  SessionCommand command;
  command.command = number;
  command.verb = verb;
  command.utime = 1000 + number;
  return command;
}

/// Says that it begins, and is done when it is let.
class Worker : public Node {
 public:
  std::string name() const override { return "worker"; }
  std::vector<std::string> Subscriptions() const override {
    return {"SESSION_COMMAND", "CLOUD|RIG"};
  }
  Messages Handle(const Message& message) override {
    const auto* command = std::get_if<SessionCommand>(&message);
    if (command == nullptr) return {};
    if (!knows_rig) throw InputError("no rig heard yet");
    asked.push_back(command->command);
    return {Says(EventKind::kProgress)};
  }
  Messages Advance(Utime) override {
    if (!done) return {};
    done = false;
    return {Says(EventKind::kDone)};
  }
  Status GetStatus() const override { return {}; }

  SessionEvent Says(EventKind kind) const {
    SessionEvent event;
    event.command = asked.back();
    event.source = "worker";
    event.kind = kind;
    event.text = "turned";
    event.sweep_utime = 77;
    return event;
  }

  std::vector<std::int64_t> asked;
  bool done = false;
  bool knows_rig = true;
};

class AnsweredCommandsTest : public ::testing::Test {
 protected:
  AnsweredCommandsTest() {
    bus_.Subscribe("SESSION_EVENT",
                   [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     said_.push_back(std::get<SessionEvent>(Decode(channel, data, size)));
                   });
  }
  void Send(const Message& message) {
    bus_.Publish(ChannelOf(message), Encode(message));
    bus_.Run();
  }
  std::vector<SessionEvent> Said() {
    bus_.Run();
    return std::exchange(said_, {});
  }

  MemoryBus bus_;
  Worker worker_;
  NodeRunner runner_{&worker_, &bus_};
  std::vector<SessionEvent> said_;
};

TEST_F(AnsweredCommandsTest, ARepeatedCommandIsCarriedOutOnceAndItsLastWordSaidAgain) {
  Send(Command(5));
  EXPECT_EQ(Said().size(), 1U);
  Send(Command(5));
  EXPECT_THAT(Said(), IsEmpty());  // it is at it
  worker_.done = true;
  runner_.Advance(1);
  ASSERT_EQ(Said().size(), 1U);
  Send(Command(5));
  const std::vector<SessionEvent> again = Said();
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].kind, EventKind::kDone);
  EXPECT_EQ(again[0].sweep_utime, 77);
  EXPECT_EQ(again[0].seq, 2);  // a message of its own
  EXPECT_THAT(worker_.asked, ElementsAre(5));
  Send(Command(6));
  EXPECT_THAT(worker_.asked, ElementsAre(5, 6));
}

// As of a process that was started anew and has not heard the rig.
TEST_F(AnsweredCommandsTest, OneThatCouldNotBeUsedIsNewWhenItIsRepeated) {
  worker_.knows_rig = false;
  Send(Command(5));
  EXPECT_THAT(Said(), IsEmpty());
  worker_.knows_rig = true;
  Send(Command(5));
  EXPECT_EQ(Said().size(), 1U);
  EXPECT_THAT(worker_.asked, ElementsAre(5));
}

TEST_F(AnsweredCommandsTest, AnotherSessionMayCountTheSame) {
  Send(Command(5));
  Send(Command(1, SessionVerb::kReset));
  Send(Command(5));
  EXPECT_THAT(worker_.asked, ElementsAre(5, 1, 5));
  Send(Command(0));
  Send(Command(0));
  EXPECT_EQ(worker_.asked.size(), 5U);  // without a number
}

TEST_F(AnsweredCommandsTest, WhatIsKeptIsBounded) {
  AnsweredCommands commands;
  for (std::int64_t i = 1; i <= 1000; ++i) EXPECT_TRUE(commands.IsNew(Command(i)));
  EXPECT_FALSE(commands.IsNew(Command(1000)));
  EXPECT_TRUE(commands.IsNew(Command(1)));
}

TEST_F(AnsweredCommandsTest, TwoSendersOnOneChannelAreNamed) {
  std::vector<std::string> problems;
  runner_.SetProblemHandler([&](const std::string& problem) { problems.push_back(problem); });
  const auto rig = [&](std::int64_t seq) {
    RigText text;
    text.seq = seq;
    text.hash = "hash";
    text.text = "text";
    Send(text);
  };
  for (int second = 0; second < 21; ++second) {
    rig(second);
    if (second == 5) rig(5);  // one that came twice
    runner_.Advance(second * kMicrosecondsPerSecond);
  }
  EXPECT_THAT(problems, IsEmpty());
  for (int second = 21; second < 41; ++second) {
    rig(second);
    rig(1000 + second);
    runner_.Advance(second * kMicrosecondsPerSecond);
  }
  EXPECT_THAT(problems, Contains(HasSubstr("RIG: its numbers fell back 10 times in 10 s: two")));
}

}  // namespace
}  // namespace rgbdt
