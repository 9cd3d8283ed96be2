// Two sessions on one in-memory bus, everybody else made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "calib/files/atomic_file.h"
#include "calib/files/session/session_dir.h"
#include "services/nodes/session_node.h"
#include "tests/nodes/bus_process.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::TinyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = SessionStep::Kind;
using Verb = SessionVerb;

constexpr Utime kListen = 2 * kMicrosecondsPerSecond;

SessionIdentity Named(std::int64_t id, const std::string& place) { return {id, place, kListen}; }

SessionScript TwoViews() {
  SessionScript script =
      test::Script({Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kNextPose, Kind::kWait,
                    Kind::kSweep, Kind::kCapture, Kind::kSolve, Kind::kEvaluate, Kind::kSave});
  script.steps[4].wait_s = 5;  // time for another one to come
  return script;
}

struct OneSession : test::Process<SessionNode> {
  template <typename... Arguments>
  explicit OneSession(Bus* bus, Arguments&&... arguments)
      : Process(bus, std::forward<Arguments>(arguments)...) {
    runner.SetProblemHandler([this](const std::string& problem) { problems.push_back(problem); });
  }
  std::vector<std::string> problems;
};

class TwoSessionsTest : public ::testing::Test {
 protected:
  TwoSessionsTest() {
    bus_.Subscribe("SESSION_COMMAND",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     OnCommand(std::get<SessionCommand>(Decode(channel, data, size)));
                   });
    bus_.Subscribe("RIG", [this](auto&&...) { ++rigs_; });
    bus_.Subscribe("SESSION_EVENT",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     events_.push_back(std::get<SessionEvent>(Decode(channel, data, size)));
                   });
  }

  std::unique_ptr<OneSession> Session(const std::string& folder, std::int64_t id) {
    return std::make_unique<OneSession>(&bus_, TwoViews(), TinyRig(), dir_ / folder,
                                        SessionNode::OnProgress(), SessionNode::BoardStands(),
                                        Named(id, "host:/" + folder));
  }
  // A tenth of a second.
  void Turn() {
    if (turn_ % 10 == 0) {
      for (const char* process : {"assembler", "detector", "fuser"}) Send(test::Ready(process));
      Status solver = test::Ready("solver");
      solver.counters = {{"views", static_cast<std::int64_t>(world_.views.size())}};
      Send(solver);
    }
    for (const auto* session : {&first_, &second_}) {
      if (*session && !(*session)->node.finished()) {
        (*session)->runner.Advance(turn_ * kMicrosecondsPerSecond / 10);
      }
    }
    bus_.Run();
    ++turn_;
  }
  void RunToTheEnd() {
    for (int i = 0; i < 600 && !(first_->node.finished() && (!second_ || second_->node.finished()));
         ++i) {
      Turn();
    }
  }
  void Send(const Message& message) { bus_.Publish(ChannelOf(message), Encode(message)); }
  void OnCommand(const SessionCommand& command) {
    if (on_command_) on_command_(command);
    for (const Message& message : world_.Answer(command)) Send(message);
  }
  std::string Calibration(const std::string& folder) const {
    return ReadWholeFile(dir_ / folder / "calibration.textproto");
  }

  test::TempDir dir_;
  MemoryBus bus_;
  test::World world_;
  std::function<void(const SessionCommand&)> on_command_;
  std::unique_ptr<OneSession> first_, second_;
  std::vector<SessionEvent> events_;
  int turn_ = 0, rigs_ = 0;
};

TEST_F(TwoSessionsTest, ItListensBeforeItSendsAnything) {
  first_ = Session("first", 5);
  while (turn_ < 20) Turn();
  EXPECT_EQ(rigs_, 0);
  EXPECT_THAT(world_.commands, IsEmpty());
  EXPECT_THAT(events_, IsEmpty());
  EXPECT_THAT(first_->node.GetStatus().text, AllOf(HasSubstr("listens"), HasSubstr("host:/first")));
  Turn();
  EXPECT_EQ(rigs_, 1);
  ASSERT_FALSE(world_.commands.empty());
  EXPECT_EQ(world_.commands[0].verb, Verb::kReset);
  RunToTheEnd();
  EXPECT_EQ(first_->node.failure(), "");
  EXPECT_THAT(first_->problems, IsEmpty()) << "its own STATUS is not another's";
  for (const SessionCommand& command : world_.commands) EXPECT_EQ(command.command >> 32, 5);
}

TEST_F(TwoSessionsTest, TheSecondIsRefusedAndTheFirstEndsAsIfUndisturbed) {
  first_ = Session("alone", 5);
  RunToTheEnd();
  const std::string undisturbed = Calibration("alone");
  for (const std::int64_t id : {4, 6}) {  // which is the larger does not matter
    world_ = test::World();
    events_.clear();
    const std::string folder = "first" + std::to_string(id);
    first_ = Session(folder, 5);
    second_.reset();
    bool begun = false;
    on_command_ = [&](const SessionCommand& command) {
      begun |= command.verb == Verb::kNextPose && command.view == "0002";
    };
    while (!begun && !first_->node.finished()) Turn();
    second_ = Session("second", id);
    RunToTheEnd();
    EXPECT_THAT(second_->node.failure(),
                AllOf(HasSubstr("start: another rgbdt-session"), HasSubstr("step "),
                      HasSubstr("host:/" + folder), HasSubstr("--lcm-url")));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "second"));
    EXPECT_EQ(first_->node.failure(), "");
    EXPECT_EQ(Calibration(folder), undisturbed);
    EXPECT_THAT(OpenSession(dir_ / folder).views, ElementsAre("0001", "0002"));
    for (const SessionCommand& command : world_.commands) EXPECT_EQ(command.command >> 32, 5);
    const auto warns =
        HasSubstr("another rgbdt-session is on this bus (it says: writes host:/second; listens");
    EXPECT_THAT(first_->problems, ElementsAre(warns)) << "once";
    EXPECT_THAT(first_->problems, Each(HasSubstr("host:/second")));
    std::vector<std::string> texts;
    for (const SessionEvent& event : events_) {
      EXPECT_NE(event.kind, EventKind::kFailed) << event.text;
      texts.push_back(event.text);
    }
    EXPECT_THAT(texts, Contains(warns)) << "for the page";
  }
}

TEST_F(TwoSessionsTest, OfTwoThatListenTheOneWithTheSmallerIdStays) {
  for (const int apart : {0, 1, 9, 15, 19}) {  // tenths of a second
    for (const bool first_stays : {true, false}) {
      std::filesystem::remove_all(dir_ / "first");
      std::filesystem::remove_all(dir_ / "second");
      world_ = test::World();
      second_.reset();
      first_ = Session("first", first_stays ? 8 : 9);
      for (int i = 0; i < apart; ++i) Turn();
      second_ = Session("second", first_stays ? 9 : 8);
      RunToTheEnd();
      const auto& stays = first_stays ? first_ : second_;
      const auto& goes = first_stays ? second_ : first_;
      EXPECT_EQ(stays->node.failure(), "") << apart;
      EXPECT_THAT(goes->node.failure(), HasSubstr("another rgbdt-session")) << apart;
      EXPECT_FALSE(std::filesystem::exists(dir_ / (first_stays ? "second" : "first")));
      EXPECT_EQ(world_.commands.front().command >> 32, 8);
    }
  }
}

// What is not in time heard of: each goes on, takes no answer to the other, and says so.
TEST_F(TwoSessionsTest, AnswersToAnothersCommandsAreIgnored) {
  first_ = Session("first", 5);
  std::vector<Message> strange;
  on_command_ = [&](const SessionCommand& command) {
    SessionCommand theirs = command;
    theirs.command += std::int64_t{1} << 32;
    SessionEvent event = world_.Event(theirs, "detector");
    event.kind = EventKind::kFailed;
    Send(event);
    ViewDetection detection;
    detection.view = "0001";
    detection.sweep_utime = 77;
    detection.cloud.why_not = "made up";
    Send(detection);
  };
  Status other = test::Ready("session", "step 1 of 3\n; writes elsewhere");
  while (world_.commands.empty()) Turn();
  Send(other);
  Send(other);
  RunToTheEnd();
  EXPECT_EQ(first_->node.failure(), "");
  EXPECT_THAT(first_->problems, ElementsAre(AllOf(HasSubstr("step 1 of 3?; writes elsewhere"),
                                                  HasSubstr("stop one of them"))))
      << "one that tells no id is another, too";
}

TEST_F(TwoSessionsTest, OneThatHasEndedIsNoReason) {
  first_ = Session("first", 5);
  second_ = Session("second", 6);
  Turn();
  Status ended = first_->node.GetStatus();
  for (auto& [name, value] : ended.counters) value = name == "ended" ? 1 : value;
  OneSession third(&bus_, TwoViews(), TinyRig(), dir_ / "third", SessionNode::OnProgress(),
                   SessionNode::BoardStands(), Named(7, "host:/third"));
  third.node.Advance(0);
  ended.process = "session";
  third.node.Handle(ended);
  EXPECT_EQ(third.node.failure(), "");
  EXPECT_FALSE(third.node.finished());
  for (auto& [name, value] : ended.counters) value = name == "ended" ? 0 : value;
  third.node.Handle(ended);
  EXPECT_TRUE(third.node.finished());
  EXPECT_THAT(test::ErrorOf([&] {
                SessionNode fresh(TinyRig(), dir_ / "fresh", {}, Named(1, ""));
                SessionRequest request;
                fresh.Handle(request);
              }),
              HasSubstr("listens"));
}

}  // namespace
}  // namespace rgbdt
