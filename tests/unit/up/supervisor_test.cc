#include "services/up/supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "calib/files/atomic_file.h"
#include "services/up/up_node.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SupervisorTest : public ::testing::Test {
 protected:
  Program Shell(const std::string& name, const std::string& script) const {
    return {name, {"/bin/sh", "-c", script}, dir_ / ("logs/" + name + ".log"), false};
  }
  void Make(std::vector<Program> programs) {
    supervisor_ = std::make_unique<Supervisor>(
        std::move(programs), [this](const std::string& line) { told_.push_back(line); });
  }
  const Supervisor::Child& child() const { return supervisor_->children().front(); }
  // Its time stands still until it is told so many lines; false: that took half a minute.
  bool Until(std::size_t lines, Utime now) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (told_.size() < lines) {
      if (std::chrono::steady_clock::now() > end) return false;
      supervisor_->Advance(now);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }

  test::TempDir dir_;
  std::vector<std::string> told_;
  std::unique_ptr<Supervisor> supervisor_;
};

TEST_F(SupervisorTest, ThePauseDoublesToHalfAMinute) {
  std::vector<double> pauses;
  for (int failures = 1; failures < 10; ++failures) {
    pauses.push_back(ToSeconds(Supervisor::PauseAfter(failures)));
  }
  EXPECT_THAT(pauses, ElementsAre(0, 0.5, 1, 2, 4, 8, 16, 30, 30));
  EXPECT_EQ(Supervisor::PauseAfter(1'000'000), Supervisor::kLongestPause);
}

TEST_F(SupervisorTest, OneThatIsKilledIsStartedAnewAtOnceAndLaterAfterAPause) {
  Make({Shell("sleeper", "exec sleep 1000")});
  ASSERT_TRUE(Until(1, kSecond));
  const pid_t first = child().pid;
  kill(first, SIGKILL);
  ASSERT_TRUE(Until(3, 2 * kSecond));
  EXPECT_THAT(told_[1], HasSubstr("sleeper: was killed by SIGKILL; again in 0.0 s"));
  EXPECT_NE(child().pid, first);
  kill(child().pid, SIGKILL);
  ASSERT_TRUE(Until(4, 3 * kSecond));
  EXPECT_THAT(told_[3], HasSubstr("again in 0.5 s"));
  supervisor_->Advance(3 * kSecond + kSecond / 4);
  EXPECT_EQ(child().pid, 0);
  supervisor_->Advance(3 * kSecond + kSecond / 2);
  EXPECT_NE(child().pid, 0);
  EXPECT_EQ(child().starts, 3);
  kill(child().pid, SIGKILL);  // it ran for long
  ASSERT_TRUE(Until(6, 20 * kSecond));
  EXPECT_THAT(told_[5], HasSubstr("again in 0.0 s"));
}

TEST_F(SupervisorTest, WhyItEndedIsToldAndWhatItPrintedIsKept) {
  Make({Shell("failing", "echo first; echo 'no such rig' >&2; exit 1")});
  ASSERT_TRUE(Until(2, kSecond));
  EXPECT_THAT(told_[1], HasSubstr("failing: ended with exit code 1: no such rig; again in"));
  EXPECT_THAT(ReadWholeFile(dir_ / "logs/failing.log"), HasSubstr("first\nno such rig\n"));
  supervisor_.reset();
  told_.clear();
  Make({{"missing", {"/nowhere/rgbdt-missing"}, dir_ / "logs/missing.log", false}});
  ASSERT_TRUE(Until(2, kSecond));
  EXPECT_THAT(told_[1], HasSubstr("missing: cannot be run: /nowhere/rgbdt-missing"));
}

TEST_F(SupervisorTest, OneThatIsToEndIsDoneAndFailsLikeTheOthers) {
  Program session = Shell("session", "test -e " + (dir_ / "done").string());
  session.ends = true;
  Make({session});
  ASSERT_TRUE(Until(3, kSecond)) << "exit code 1: started anew";
  EXPECT_FALSE(child().done);
  WriteFileAtomically(dir_ / "done", "");
  for (Utime now = 10 * kSecond; !child().done && now < 10'000 * kSecond; now += kSecond) {
    supervisor_->Advance(now);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(child().done);
  EXPECT_THAT(told_.back(), "session: ended with exit code 0");
}

// `doubtful` is 3, `do not use` 4: saved all the same, and to be started anew it would be refused.
TEST_F(SupervisorTest, ASessionThatEndsByItsVerdictIsDone) {
  for (const char* code : {"3", "4"}) {
    told_.clear();
    Program session = Shell("session", std::string("exit ") + code);
    session.ends = true;
    Make({session});
    ASSERT_TRUE(Until(2, kSecond));
    EXPECT_TRUE(child().done) << told_.back();
    EXPECT_EQ(told_.back(), std::string("session: ended with exit code ") + code);
  }
  Program solver = Shell("solver", "exit 3");
  Make({solver});
  told_.clear();
  ASSERT_TRUE(Until(2, kSecond));
  EXPECT_FALSE(child().done) << "it is to run for as long as the rig is up";
}

TEST_F(SupervisorTest, ItIsNoticedWhereEndsOfChildrenWereIgnored) {
  signal(SIGCHLD, SIG_IGN);
  Make({Shell("failing", "exit 1")});
  const bool noticed = Until(2, kSecond);
  signal(SIGCHLD, SIG_DFL);
  ASSERT_TRUE(noticed);
  EXPECT_THAT(told_.at(1), HasSubstr("failing: ended with exit code 1"));
}

TEST_F(SupervisorTest, StopEndsAllOfThem) {
  Make({Shell("a", "exec sleep 1000"), Shell("b", "exec sleep 1000")});
  ASSERT_TRUE(Until(2, kSecond));
  std::vector<pid_t> pids;
  for (const Supervisor::Child& child : supervisor_->children()) pids.push_back(child.pid);
  supervisor_.reset();
  for (const pid_t pid : pids) EXPECT_EQ(kill(pid, 0), -1);
  EXPECT_THAT(told_.back(), "b: was killed by SIGTERM");
}

TEST_F(SupervisorTest, ALogThatCannotBeWrittenIsNamed) {
  WriteFileAtomically(dir_ / "logs", "a file");
  EXPECT_THAT(test::ErrorOf([&] { Make({Shell("a", "exit 0")}); }),
              AllOf(HasSubstr("cannot write"), HasSubstr("logs/a.log")));
}

TEST_F(SupervisorTest, TheTableTellsWhatEachSays) {
  UpNode node(
      {Shell("detector", "exec sleep 1000"), Shell("solver", "exec sleep 1000")}, [](auto&&...) {},
      [](auto&&...) {});
  node.Advance(kSecond);
  Status status;
  status.process = "detector";
  status.text = "waits for a capture";
  status.counters = {{"received", 100}, {"dropped", 2}, {"gaps", 3}};
  node.Handle(status);
  node.Advance(3 * kSecond);
  status.counters[0].second = 160;
  node.Handle(status);
  status.process = "a stranger";
  node.Handle(status);
  EXPECT_THAT(node.Table(), ::testing::ContainsRegex(
                                "detector +runs +30 +5 +0  waits for a capture\nsolver +runs"));
  EXPECT_THAT(node.Table(), ::testing::Not(HasSubstr("stranger")));
  EXPECT_TRUE(node.GetStatus().ready);
  node.Advance(10 * kSecond);
  EXPECT_THAT(node.Table(), ::testing::Not(HasSubstr("waits for a capture"))) << "it is silent";
}

TEST(RigPrograms, AreThoseOfItsDevicesAndTheSession) {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].name = "rgb";
  rig.cameras[1].name = "thermal";
  UpOptions options;
  options.programs = "/bin";
  options.rig = "rig.textproto";
  options.out = "out";
  options.logs = "logs";
  const auto names = [&] {
    std::vector<std::string> all;
    for (const Program& program : ProgramsOf(rig, options)) all.push_back(program.name);
    return all;
  };
  EXPECT_THAT(names(), ElementsAre("detector", "solver", "fuser", "session", "viewer"))
      << "nothing to assemble";
  rig.cameras[0].device = CameraDevice();
  rig.lidar.device = HokuyoDevice();
  rig.lidar.turned_scanner.emplace();
  rig.lidar.turned_scanner->motor = DynamixelDevice();
  options.listen = "0.0.0.0:80";
  options.url = "udpm://";
  EXPECT_THAT(names(), ElementsAre("camera-rgb", "lidar", "motor", "assembler", "detector",
                                   "solver", "fuser", "session", "viewer"));
  const std::vector<Program> all = ProgramsOf(rig, options);
  EXPECT_THAT(all[0].arguments,
              ElementsAre("/bin/rgbdt-camera", "--rig", "rig.textproto", "--camera", "rgb",
                          "--captures", "out.captures", "--lcm-url", "udpm://"));
  EXPECT_THAT(all[7].arguments, ElementsAre("/bin/rgbdt-session", "--rig", "rig.textproto", "--out",
                                            "out", "--lcm-url", "udpm://"));
  EXPECT_TRUE(all[7].ends);
  EXPECT_FALSE(all[1].ends) << "a scanner is no recording";
  EXPECT_THAT(all[8].arguments,
              ElementsAre("/bin/rgbdt-viewer", "--listen", "0.0.0.0:80", "--lcm-url", "udpm://"));
  options.key = "rig.key";
  for (const Program& program : ProgramsOf(rig, options)) {
    const auto& given = program.arguments;
    EXPECT_THAT(std::vector<std::string>(given.end() - 2, given.end()),
                ElementsAre("--key", "rig.key"))
        << program.name;
  }
}

}  // namespace
}  // namespace rgbdt
