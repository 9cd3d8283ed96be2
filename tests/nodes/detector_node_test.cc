#include "services/nodes/detector_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/nodes/assembler_node.h"
#include "services/simulator/simulator_node.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::BytesOf;
using test::Counter;
using test::ErrorOf;
using test::Only;
using ::testing::HasSubstr;

constexpr Utime kCommand = kSweep + 2 * kMicrosecondsPerSecond;

const Rig& SmallRig() {
  static const Rig rig = test::RigOf(simulate::Simulator(test::TinyOptions()));
  return rig;
}

SessionCommand Capture(std::vector<std::string> picked = {}) {
  SessionCommand command;
  command.command = 7;
  command.verb = SessionVerb::kCapture;
  command.utime = kCommand;
  command.view = "0001";
  command.sweep_utime = kSweep;
  command.picked_cameras = std::move(picked);
  return command;
}

// Grey all over: no board.
Image Blank(const std::string& name, Utime utime = kCommand) {
  const CameraSpec& camera = SmallRig().Camera(name);
  Image image;
  image.camera = name;
  image.utime = utime;
  image.format = camera.format;
  image.pixels = cv::Mat(camera.height, camera.width,
                         camera.kind == CameraKind::kThermal ? CV_16UC1 : CV_8UC1, cv::Scalar(90));
  return image;
}

Messages EmptySweep() {
  CloudChunk line;
  line.cloud.sweep_utime = kSweep;
  line.cloud.lines = 1;
  line.cloud.beams = 4;
  line.cloud.points.assign(4, Eigen::Vector3f(3, 0, 0));
  CloudChunk end;
  end.cloud.sweep_utime = kSweep;
  end.sweep_end = true;
  end.sweep_lines = 1;
  return {line, end};
}

// But for its number and how long it took.
Messages WhatItSays(const Message& message) {
  auto detection = std::get<ViewDetection>(message);
  detection.seq = 0;
  detection.cloud.detect_s = 0;
  for (ImageDetection& image : detection.images) image.detect_s = 0;
  return {detection};
}

class DetectorNodeTest : public ::testing::Test {
 protected:
  DetectorNodeTest() { node_.Handle(test::TextOf(SmallRig())); }
  DetectorNode node_;
};

TEST(DetectorNodeRigTest, BeforeTheRigNothingIsTaken) {
  DetectorNode node;
  EXPECT_FALSE(node.GetStatus().ready);
  EXPECT_THAT(ErrorOf([&] { node.Handle(Capture()); }), HasSubstr("no rig heard yet"));
  node.Handle(test::TextOf(SmallRig()));
  EXPECT_TRUE(node.GetStatus().ready);
}

TEST_F(DetectorNodeTest, AViewWithoutABoardIsOneDetectionWithReasonsAndDone) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  EXPECT_TRUE(node_.Handle(Blank("rgb")).empty());
  EXPECT_EQ(node_.GetStatus().text, "view 0001 waits for an image of camera thermal");
  const Messages out = node_.Handle(Blank("thermal"));
  ASSERT_EQ(out.size(), 2U) << "one DETECTION, then the event";
  const auto& detection = std::get<ViewDetection>(out[0]);
  EXPECT_EQ(detection.view, "0001");
  EXPECT_EQ(detection.sweep_utime, kSweep);
  ASSERT_EQ(detection.images.size(), 2U);
  for (const ImageDetection& image : detection.images) {
    EXPECT_FALSE(image.usable());
    EXPECT_FALSE(image.why_not.empty());
    EXPECT_EQ(image.utime, kCommand);
  }
  EXPECT_TRUE(detection.cloud.candidates.empty());
  EXPECT_FALSE(detection.cloud.why_not.empty());
  const auto events = Only<SessionEvent>(out);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].command, 7);
  EXPECT_EQ(events[0].kind, EventKind::kDone);
  EXPECT_EQ(events[0].utime, kCommand);
  EXPECT_EQ(events[0].text, "rgb: " + detection.images[0].why_not +
                                "; thermal: " + detection.images[1].why_not +
                                "; cloud: " + detection.cloud.why_not);
  EXPECT_EQ(Counter(node_.GetStatus(), "views"), 1);
  EXPECT_EQ(Counter(node_.GetStatus(), "images without board"), 2);
  EXPECT_EQ(Counter(node_.GetStatus(), "clouds without board"), 1);
  EXPECT_EQ(node_.GetStatus().text, "waits for a capture");
}

TEST_F(DetectorNodeTest, ImagesOfTheWrongKindAreRefusedAndChangeNothing) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  node_.Handle(Blank("rgb"));
  const std::string waits = node_.GetStatus().text;

  Image small = Blank("thermal");
  small.pixels = cv::Mat(10, 20, CV_16UC1, cv::Scalar(0));
  EXPECT_THAT(ErrorOf([&] { node_.Handle(small); }), HasSubstr("20x10"));
  Image coloured = Blank("thermal");
  coloured.format = PixelFormat::kBgr8;
  coloured.pixels = cv::Mat(coloured.pixels.size(), CV_8UC3, cv::Scalar(0, 0, 0));
  EXPECT_THAT(ErrorOf([&] { node_.Handle(coloured); }), HasSubstr("thermal"));
  Image stranger = Blank("thermal");
  stranger.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(stranger); }), HasSubstr("front"));
  CornerSelection picks;
  picks.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(picks); }), HasSubstr("front"));

  EXPECT_EQ(node_.GetStatus().text, waits);
  EXPECT_EQ(node_.Handle(Blank("thermal")).size(), 2U);
}

TEST_F(DetectorNodeTest, PicksInAnImageOfAViewHaveItDetectedAgain) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  const Messages first = test::HandleAll(&node_, {Blank("rgb"), Blank("thermal")});
  CornerSelection picks;
  picks.camera = "thermal";
  picks.utime = kCommand + 1;
  picks.image_utime = kCommand + 1;
  picks.corners = {{{5, 5}, {50, 5}, {50, 40}, {5, 40}}};
  EXPECT_TRUE(node_.Handle(picks).empty()) << "no view has an image of that time";
  picks.image_utime = kCommand;
  const Messages again = node_.Handle(picks);
  ASSERT_EQ(Only<ViewDetection>(again).size(), 1U);
  EXPECT_EQ(Only<ViewDetection>(again)[0].view, "0001");
  ASSERT_EQ(Only<SessionEvent>(again).size(), 1U);
  EXPECT_EQ(Only<SessionEvent>(again)[0].command, Only<SessionEvent>(first)[0].command);
  EXPECT_EQ(Counter(node_.GetStatus(), "views"), 1);
  SessionCommand reset;
  reset.verb = SessionVerb::kReset;
  node_.Handle(reset);
  EXPECT_TRUE(node_.Handle(picks).empty()) << "the view is forgotten";
}

// As where this process or the assembler was started in the midst of the sweep.
TEST_F(DetectorNodeTest, AViewWhoseSweepLacksItsFirstLinesHasFailed) {
  Messages sweep = EmptySweep();
  std::get<CloudChunk>(sweep[0]).cloud.first_line = 3;
  std::get<CloudChunk>(sweep[1]).sweep_lines = 4;
  test::HandleAll(&node_, sweep);
  node_.Handle(Capture());
  const Messages out = test::HandleAll(&node_, {Blank("rgb"), Blank("thermal")});
  ASSERT_EQ(out.size(), 1U) << "no DETECTION";
  const auto& event = std::get<SessionEvent>(out[0]);
  EXPECT_EQ(event.command, 7);
  EXPECT_EQ(event.kind, EventKind::kFailed);
  EXPECT_EQ(event.sweep_utime, kSweep);
  EXPECT_THAT(event.text, HasSubstr("3 of its 4 lines never came"));
  EXPECT_EQ(Counter(node_.GetStatus(), "sweeps not whole"), 1);
  EXPECT_EQ(Counter(node_.GetStatus(), "views"), 0);
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("view 0001 waits for lines of sweep"));
  CornerSelection picks;
  picks.camera = "thermal";
  picks.image_utime = kCommand;
  picks.corners = {{{5, 5}, {50, 5}, {50, 40}, {5, 40}}};
  EXPECT_TRUE(node_.Handle(picks).empty()) << "the view is not kept, and it is said once";
}

TEST_F(DetectorNodeTest, LinesThatAreSaidAgainCompleteIt) {
  Messages sweep = EmptySweep();
  test::HandleAll(&node_, {sweep[1]});
  node_.Handle(Capture());
  ASSERT_EQ(test::HandleAll(&node_, {Blank("rgb"), Blank("thermal")}).size(), 1U);
  const Messages out = node_.Handle(sweep[0]);
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(std::get<ViewDetection>(out[0]).sweep_utime, kSweep);
  EXPECT_EQ(std::get<SessionEvent>(out[1]).kind, EventKind::kDone);
}

TEST_F(DetectorNodeTest, SaysAViewAgainFromWhichAnotherOneDetectsTheSame) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  const Messages first = test::HandleAll(&node_, {Blank("rgb"), Blank("thermal")});
  SessionCommand say = Capture();
  say.command = 0;
  say.verb = SessionVerb::kSayView;
  Messages again = node_.Handle(say);
  ASSERT_GE(again.size(), 2U + 2U + 2U) << "images, chunks, detection and event";
  const auto word = std::get<SessionEvent>(again.back());
  EXPECT_EQ(word.command, 7);
  again.pop_back();
  const auto detection = std::get<ViewDetection>(again.back());
  again.pop_back();
  EXPECT_EQ(BytesOf(WhatItSays(detection)), BytesOf(WhatItSays(first[0])));
  for (const Message& message : again) EXPECT_EQ(SeqOf(message), kSaidAgain);

  DetectorNode other;
  other.Handle(test::TextOf(SmallRig()));
  other.Handle(Capture());
  const Messages same = test::HandleAll(&other, again);
  ASSERT_EQ(same.size(), 2U);
  EXPECT_EQ(BytesOf(WhatItSays(same[0])), BytesOf(WhatItSays(first[0])));
  EXPECT_TRUE(node_.Handle(say).empty()) << "strangers may ask a thousand times a second";
  node_.Advance(DetectorNode::kSayEvery);
  say.sweep_utime += 1;
  EXPECT_TRUE(node_.Handle(say).empty()) << "another sweep's";
  say.sweep_utime -= 1;
  EXPECT_FALSE(node_.Handle(say).empty());
}

// As a process calls it that has nothing to handle.
Messages Spare(DetectorNode* node, Utime now) {
  Messages said = node->UseSpareTime(now);
  node->Advance(now);
  return said;
}

TEST_F(DetectorNodeTest, SaysOncePerImageAndSweepWhoSeesTheBoard) {
  EXPECT_TRUE(Spare(&node_, 0).empty());
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Blank("thermal"));
  Messages said;
  for (Utime now = 1; now < 10; ++now) {
    for (Message& message : Spare(&node_, now * kMicrosecondsPerSecond)) {
      said.push_back(std::move(message));
    }
  }
  const auto statuses = Only<TargetStatus>(said);
  ASSERT_EQ(statuses.size(), 2U);
  EXPECT_EQ(statuses[0].camera, "thermal");
  EXPECT_EQ(statuses[1].camera, "");
  for (const TargetStatus& status : statuses) {
    EXPECT_FALSE(status.seen);
    EXPECT_NE(status.text, "");
  }
  node_.Handle(Capture());
  node_.Handle(Blank("rgb", kCommand - 1));
  EXPECT_TRUE(Spare(&node_, 100 * kMicrosecondsPerSecond).empty()) << "a capture comes first";
}

TEST_F(DetectorNodeTest, LooksAsOftenAsItHasTimeFor) {
  // It is called so often, with a new image each time, and a look takes that long.
  Utime begin = 0;
  const auto looks_in_ten_seconds = [&](Utime every) {
    std::size_t looks = 0;
    for (Utime now = every; now <= 10 * kMicrosecondsPerSecond; now += every) {
      node_.Handle(Blank("thermal", kCommand + begin + now));
      node_.Advance(begin + now);
      looks += Only<TargetStatus>(node_.UseSpareTime(begin + now)).size();
    }
    begin += 11 * kMicrosecondsPerSecond;
    return looks;
  };
  EXPECT_NEAR(static_cast<double>(looks_in_ten_seconds(20'000)), 100, 2);
  EXPECT_NEAR(static_cast<double>(looks_in_ten_seconds(50'000)), 50, 2) << "a quarter of a core";
  EXPECT_NEAR(static_cast<double>(looks_in_ten_seconds(500'000)), 10, 1) << "once a second";
}

TEST_F(DetectorNodeTest, WithoutSpareTimeItDoesNotLook) {
  node_.Handle(Blank("thermal"));
  EXPECT_TRUE(node_.Advance(kMicrosecondsPerSecond).empty());
  EXPECT_FALSE(node_.UseSpareTime(kMicrosecondsPerSecond).empty());
}

TEST_F(DetectorNodeTest, ResetForgetsTheCapture) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  SessionCommand reset;
  reset.verb = SessionVerb::kReset;
  node_.Handle(reset);
  EXPECT_EQ(node_.GetStatus().text, "waits for a capture");
  EXPECT_TRUE(test::HandleAll(&node_, {Blank("rgb"), Blank("thermal")}).empty());
}

TEST_F(DetectorNodeTest, AnotherRigForgetsEverything) {
  test::HandleAll(&node_, EmptySweep());
  node_.Handle(Capture());
  node_.Handle(Blank("rgb"));
  RigText other = test::TextOf(SmallRig());
  other.text += "# moved\n";
  other.hash = HashOfRigText(other.text);
  node_.Handle(other);
  EXPECT_EQ(node_.GetStatus().text, "waits for a capture");
}

// One view of the synthetic rig: found by both cameras, the same in whatever order it comes.
TEST(DetectorNodeViewTest, FindsTheBoardInWhateverOrderTheViewComes) {
  simulate::Simulator simulator(test::HalfSizeOptions());
  const Rig rig = test::RigOf(simulator);
  simulator.ShowView(0, "0001");
  AssemblerNode assembler;
  Messages sweep = {test::TextOf(rig)};
  const Utime end = kSweep + simulator.sweep_lines() * simulator.line_period();
  for (Utime t = kSweep; t < end + 300'000; t += SimulatorNode::kEncoderPeriod) {
    sweep.push_back(simulator.Encoder(t, t <= end ? kSweep : 0));
  }
  for (int i = 0; i < simulator.sweep_lines(); ++i) {
    LineScan line = simulator.Line(kSweep, i);
    line.seq = i;
    sweep.insert(sweep.begin() + 1 + i, line);
  }
  const Messages cloud = test::HandleAll(&assembler, sweep);
  const Utime now = end + kMicrosecondsPerSecond;
  SessionCommand command = Capture({"thermal"});
  command.utime = now;
  const Messages images = {simulator.TakeImage("rgb", now), simulator.TakeImage("thermal", now)};
  const Message picks = simulator.PickCorners("thermal", now);

  const auto detect = [&](const std::vector<Messages>& parts) {
    DetectorNode node;
    node.Handle(test::TextOf(rig));
    Messages out;
    for (const Messages& part : parts) {
      for (Message& message : test::HandleAll(&node, part)) out.push_back(std::move(message));
    }
    for (Message& message : out) {
      if (auto* detection = std::get_if<ViewDetection>(&message)) {  // the wall clock's part
        for (ImageDetection& image : detection->images) image.detect_s = 0;
        detection->cloud.detect_s = 0;
      }
    }
    return out;
  };
  const Messages expected = detect({cloud, {command}, images, {picks}});
  ASSERT_EQ(expected.size(), 2U);
  const auto& detection = std::get<ViewDetection>(expected[0]);
  ASSERT_EQ(detection.images.size(), 2U);
  for (const ImageDetection& image : detection.images) {
    ASSERT_TRUE(image.usable()) << image.camera << ": " << image.why_not;
    EXPECT_FALSE(image.edges->picked) << "the board is detected automatically";
  }
  ASSERT_FALSE(detection.cloud.candidates.empty()) << detection.cloud.why_not;
  EXPECT_EQ(BytesOf(detect({{picks}, images, {command}, cloud})), BytesOf(expected));

  // The cloud is looked at where an image shows nothing.
  Messages covered = images;
  cv::Mat& pixels = std::get<Image>(covered[0]).pixels;
  pixels = cv::Mat(pixels.size(), pixels.type(), cv::Scalar(90));  // not in place: they are shared
  const Messages without_rgb = detect({cloud, {command}, covered, {picks}});
  ASSERT_EQ(without_rgb.size(), 2U);
  const auto& blind = std::get<ViewDetection>(without_rgb[0]);
  EXPECT_FALSE(blind.images.at(0).usable());
  EXPECT_TRUE(blind.images.at(1).usable()) << blind.images[1].why_not;
  ASSERT_EQ(blind.cloud.candidates.size(), detection.cloud.candidates.size());
  EXPECT_EQ(blind.cloud.candidates[0].boundary, detection.cloud.candidates[0].boundary);

  DetectorNode watching;
  test::HandleAll(&watching, {test::TextOf(rig)});
  test::HandleAll(&watching, cloud);
  test::HandleAll(&watching, images);
  for (Utime now = 0; now < 3; ++now) {
    const Messages said = Spare(&watching, now * kMicrosecondsPerSecond);
    const TargetStatus status = Only<TargetStatus>(said).at(0);
    EXPECT_TRUE(status.seen) << status.camera << ": " << status.text;
    if (status.camera.empty()) {
      EXPECT_LT((status.centre - detection.cloud.candidates[0].centre).norm(), 1e-6);
      continue;
    }
    const auto& edges = *detection.Find(status.camera)->edges;
    ASSERT_EQ(status.corners.size(), edges.corners.size());
    EXPECT_LT((status.corners[3] - edges.corners[3]).norm(), 1.0) << status.camera;
    EXPECT_EQ(status.outline.size() % 4, 0U);
    EXPECT_LT((status.outline[0] - edges.outline_corners[0]).norm(), 2.0) << status.camera;
  }
}

}  // namespace
}  // namespace rgbdt
