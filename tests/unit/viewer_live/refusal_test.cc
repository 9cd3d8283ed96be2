// What node.h promises, of the viewer's node: a message that it refuses leaves no trace, neither in
// what it publishes nor in what browsers get.
#include <gmock/gmock.h>

#include "tests/nodes/session_world.h"
#include "tests/nodes/twins.h"
#include "viewer/live/live_node.h"

namespace rgbdt::viewer {
namespace {

using test::kStart;
using test::TinyRig;

class PostedText : public Outbox {
 public:
  void Send(Post post) override { all += post.topic + ": " + post.make() + "\n"; }
  void Forget(const std::string& prefix) override { all += "forget " + prefix + "\n"; }
  std::string all;
};

TEST(Refusal, LiveNode) {
  PostedText posts, twins_posts;
  LiveNode node, twin;
  node.PostTo(&posts);
  twin.PostTo(&twins_posts);
  Image wrong_size = test::Blank(TinyRig().cameras[0], kStart);
  wrong_size.pixels = cv::Mat(4, 4, CV_8UC1, cv::Scalar(0));
  TargetStatus stranger;
  stranger.camera = "front";
  CalibrationMessage strangers;
  strangers.calibration.camera = "front";

  test::Twins twins(&node, &twin);
  twins.bad = {RigText{0, "another hash", "cameras { nonsense }"},
               ReportText{0, kStart, "{ \"nonsense\""}};
  twins.Feed({test::TextOf(TinyRig())});
  CalibrationMessage of_another_rig;
  of_another_rig.rig_hash = "another rig's";
  of_another_rig.calibration.camera = "rgb";
  for (Message& bad : Messages{wrong_size, stranger, strangers, of_another_rig}) {
    twins.bad.push_back(std::move(bad));
  }
  TargetStatus status;
  status.camera = "rgb";
  status.seen = true;
  TargetStatus of_lidar;
  of_lidar.text = "too far away";
  CalibrationMessage calibration;
  calibration.utime = kStart;
  calibration.rig_hash = TinyRig().hash;
  calibration.calibration.camera = "rgb";
  test::World world;
  Messages good = {status, of_lidar, calibration, test::Ready("session")};
  SessionCommand command;
  command.command = 1;
  command.verb = SessionVerb::kSweep;
  for (Message& message : world.Answer(command)) good.push_back(std::move(message));
  command.sweep_utime = world.now;
  command.utime = world.now;
  command.view = "0001";
  command.verb = SessionVerb::kCapture;
  good.push_back(command);
  for (Message& message : world.Answer(command)) good.push_back(std::move(message));
  command.verb = SessionVerb::kSolve;
  for (Message& message : world.Answer(command)) good.push_back(std::move(message));
  good.push_back(status);
  twins.Feed(good);
  EXPECT_THAT(twins.refused, ::testing::Each(::testing::Gt(5)));
  EXPECT_EQ(posts.all, twins_posts.all);
  EXPECT_NE(posts.all.find("thumb/0001/rgb"), std::string::npos);
}

}  // namespace
}  // namespace rgbdt::viewer
