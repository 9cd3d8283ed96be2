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
  log.Add("CLOUD: worse", 5'000'000);
  EXPECT_EQ(lines, (std::vector<std::string>{"CLOUD: bad", "CLOUD: bad (and 49 times more since)",
                                             "CLOUD: worse"}));
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
