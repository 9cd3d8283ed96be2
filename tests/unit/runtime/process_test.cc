#include "services/runtime/process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "services/bus/bus.h"

namespace rgbdt {
namespace {

class SilentNode : public Node {
 public:
  std::string name() const override { return "silent"; }
  std::vector<std::string> Subscriptions() const override { return {"ENCODER"}; }
  Messages Handle(const Message&) override {
    ++handled;
    return {};
  }
  Status GetStatus() const override { return {}; }
  int handled = 0;
};

/// Speaks to itself, and ends after ten turns; or ends by a signal.
class TalkingNode : public SilentNode {
 public:
  Messages Advance(Utime) override {
    if (signal != 0) raise(signal);
    ++turns;
    return {EncoderReading{1, 0, 0, 0}};
  }
  Utime LongestWait() const override { return 2000; }
  bool finished() const override { return turns >= 10; }
  int turns = 0;
  int signal = 0;
};

TEST(ProblemLog, TheSameAtMostEveryFiveSeconds) {
  std::vector<std::string> lines;
  ProblemLog log([&](const std::string& line) { lines.push_back(line); });
  for (int i = 0; i <= 50; ++i) log.Add("CLOUD: bad", 100'000 * i);
  log.Add("CLOUD: worse", 6'000'000);
  EXPECT_EQ(lines, (std::vector<std::string>{"CLOUD: bad", "CLOUD: bad (and 49 more since)",
                                             "CLOUD: worse"}));
}

// A thousand a second for a minute, no two alike, on two channels and on made-up ones.
TEST(ProblemLog, AVariedFloodIsALineAChannelAndSecondAndNoneIsUncounted) {
  std::vector<std::string> lines;
  ProblemLog log([&](const std::string& line) { lines.push_back(line); });
  constexpr int kFlood = 60'000;
  for (int i = 0; i < kFlood; ++i) {
    const Utime now = 1000 * i;
    log.Advance(now);
    log.Add("CLOUD: num_points is " + std::to_string(i), now);
    log.Add("RGB" + std::to_string(i) + "_IMAGE: width is " + std::to_string(-i), now);
  }
  EXPECT_EQ(lines.size(), 120U);
  log.Advance(1000 * (kFlood + 5000));
  EXPECT_EQ(lines.size(), 122U);
  std::int64_t told = 0;
  for (const std::string& line : lines) {
    const std::size_t more = line.find("(and ");
    told += 1 + (more == std::string::npos ? 0 : std::stoll(line.substr(more + 5)));
  }
  EXPECT_EQ(told, 2 * kFlood);
  EXPECT_EQ(lines[120], "CLOUD: num_points is 59999 (and 998 more since)");
  log.Advance(1000 * (kFlood + 20'000));
  EXPECT_EQ(lines.size(), 122U) << "it is told once";
}

TEST(ProblemLog, SomethingElseOfASourceIsToldAtOnceAndThatIsBoundedToo) {
  std::vector<std::string> lines;
  ProblemLog log([&](const std::string& line) { lines.push_back(line); });
  log.Add("rgb: no frame for 3.0 s", 0);
  log.Add("rgb: no camera at 10.0.0.1", 1000);
  log.Add("rgb: no camera at 10.0.0.2", 1500);
  log.Add("rgb: back after 5 s", 2000);
  EXPECT_EQ(lines, (std::vector<std::string>{"rgb: no frame for 3.0 s",
                                             "rgb: no camera at 10.0.0.1", "rgb: back after 5 s"}));
  std::string text = "rgb: ";
  for (int i = 0; i < 100; ++i) log.Add(text += static_cast<char>('a' + i % 26), 3000 + i);
  EXPECT_EQ(lines.size(), 8U);
}

TEST(ProblemLog, ManyMadeUpSourcesAreBoundedTogetherAndForgotten) {
  std::vector<std::string> lines;
  ProblemLog log([&](const std::string& line) { lines.push_back(line); });
  std::string name = "a";
  for (int i = 0; i < 1000; ++i) {
    log.Add(name + "_IMAGE: bad", 1000 * i);
    name += static_cast<char>('a' + i % 26);
  }
  EXPECT_LE(lines.size(), 52U);
  log.Advance(20'000'000);
  log.Advance(40'000'000);
  lines.clear();
  for (const char* source : {"CLOUD: bad", "IMU: bad", "POSE: bad"}) log.Add(source, 40'000'001);
  EXPECT_EQ(lines, (std::vector<std::string>{"CLOUD: bad", "IMU: bad", "POSE: bad"}));
}

// LCM's memory queue needs no network: the whole loop of a process in a test.
TEST(RunOnLcm, DeliversUntilTheNodeIsFinished) {
  TalkingNode node;
  EXPECT_EQ(RunOnLcm(node, {"memq://"}), 0);
  EXPECT_EQ(node.turns, 10);
  EXPECT_GE(node.handled, 8);
}

TEST(RunOnLcm, SignalEndsItCleanly) {
  for (const int signal : {SIGINT, SIGTERM}) {
    TalkingNode node;
    node.signal = signal;
    EXPECT_EQ(RunOnLcm(node, {"memq://"}), 0);
    EXPECT_EQ(node.turns, 1);
  }
}

TEST(RunOnLcm, BadUrlIsOneLineAndExitCodeOne) {
  SilentNode node;
  EXPECT_EQ(RunOnLcm(node, {"nonsense://"}), 1);
  EXPECT_EQ(RunOnLcm(node, {"udpm://1.2.3.4:7667"}), 1);
}

TEST(CompleteUrl, AsksForAReceiveBuffer) {
  setenv("LCM_DEFAULT_URL", "udpm://239.255.1.1:5000?ttl=1", 1);
  EXPECT_EQ(CompleteUrl(""), "udpm://239.255.1.1:5000?ttl=1&recv_buf_size=33554432");
  unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(CompleteUrl(""), "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=33554432");
  EXPECT_EQ(CompleteUrl("udpm://239.1.1.1:5000"), "udpm://239.1.1.1:5000?recv_buf_size=33554432");
  EXPECT_EQ(CompleteUrl("udpm://?recv_buf_size=100"), "udpm://?recv_buf_size=100");
  EXPECT_EQ(CompleteUrl("file://x.lcm?speed=0"), "file://x.lcm?speed=0");
}

}  // namespace
}  // namespace rgbdt
