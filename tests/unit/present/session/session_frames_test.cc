#include "calib/present/session/session_frames.h"

#include "calib/files/session/session_dir.h"
#include "calib/model/version.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/present/frames/frame_testing.h"

namespace rgbdt {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A session of three views; the small rig and random pixels of tests/unit/files.
class SessionFramesTest : public ::testing::Test {
 protected:
  SessionFramesTest() {
    WriteRig(dir_.path(), test::MakeRig());
    View view = test::MakeView();
    cv::randu(view.images[1].pixels, 7000, 8000);  // warmer than what they mirror
    for (const char* name : {"0001", "0002", "0003"}) {
      view.name = name;
      WriteView(dir_.path(), view);
    }
    session_ = OpenSession(dir_.path());
    options_.title = "a session";
  }

  std::vector<NamedFrame> Frames() const {
    const std::vector<Report> reports = {test::MakeReport()};
    return SessionFrames({session_, detections_, reports}, options_);
  }

  static ViewDetection Seen(const std::string& view) {
    CloudEdges board;
    board.centre = {2, 0, 0};
    board.normal = {-1, 0, 0};
    ViewDetection detection;
    detection.view = view;
    for (const char* camera : {"rgb", "thermal"}) {
      detection.images.push_back({camera, 17, ImageEdges(), "", 0});
    }
    detection.cloud.candidates = {board};
    return detection;
  }

  static json Header(const std::vector<NamedFrame>& frames, const std::string& topic) {
    for (const NamedFrame& frame : frames) {
      if (frame.topic == topic) return Parse(frame.bytes).header;
    }
    ADD_FAILURE() << "no frame " << topic;
    return {};
  }

  static std::vector<std::string> Topics(const std::vector<NamedFrame>& frames) {
    std::vector<std::string> topics;
    for (const NamedFrame& frame : frames) topics.push_back(frame.topic);
    return topics;
  }

  test::TempDir dir_;
  Session session_;
  std::vector<ViewDetection> detections_;
  SessionFramesOptions options_;
};

TEST_F(SessionFramesTest, ComeInTheOrderInWhichAPageTakesThem) {
  detections_ = {Seen("0003"), Seen("0001")};  // any order
  std::swap(detections_[0].images[0], detections_[0].images[1]);
  const std::vector<NamedFrame> frames = Frames();
  EXPECT_THAT(Topics(frames),
              testing::ElementsAre(
                  "hello", "rig", "session", "thumb/0001/rgb", "thumb/0001/thermal", "thumb/0001/",
                  "thumb/0002/rgb", "thumb/0002/thermal", "thumb/0003/rgb", "thumb/0003/thermal",
                  "thumb/0003/", "image/0001/rgb", "overlay/0001/rgb", "image/0001/thermal",
                  "overlay/0001/thermal", "image/0002/rgb", "image/0002/thermal", "image/0003/rgb",
                  "overlay/0003/rgb", "image/0003/thermal", "overlay/0003/thermal",
                  "image/sigma/rgb", "cloud/0001", "cloud/0002", "cloud/0003"));
  EXPECT_EQ(Header(frames, "cloud/0002").at("view"), "0002");
  const json hello = Header(frames, "hello");
  EXPECT_EQ(hello.at("source"), "session");
  EXPECT_EQ(hello.at("title"), "a session");
  EXPECT_EQ(hello.at("version"), Version());
  EXPECT_EQ(hello.at("may_command"), false);
  const json session = Header(frames, "session");
  EXPECT_EQ(session.at("mode"), "finished");
  EXPECT_EQ(session.at("views").size(), 3U);
  EXPECT_EQ(session.at("sigma").back().at("views"), 5);
  const json image = Header(frames, "image/0003/thermal");
  EXPECT_EQ(image.at("view"), "0003");
  EXPECT_EQ(image.at("ack"), false);
  EXPECT_TRUE(image.at("min_k").is_number());
  EXPECT_EQ(Header(frames, "overlay/0001/rgb").at("calibrated"), true);
}

TEST_F(SessionFramesTest, TheSameSessionGivesTheSameBytes) {
  detections_ = {Seen("0001"), Seen("0002")};
  const std::vector<NamedFrame> frames = Frames();
  const std::vector<NamedFrame> again = Frames();
  ASSERT_EQ(frames.size(), again.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].topic, again[i].topic);
    EXPECT_TRUE(frames[i].bytes == again[i].bytes) << frames[i].topic;
  }
}

TEST_F(SessionFramesTest, WithoutPointsThereAreNoClouds) {
  options_.points = options_.other_points = 0;
  EXPECT_THAT(Topics(Frames()), testing::Not(testing::Contains(HasSubstr("cloud/"))));
}

TEST_F(SessionFramesTest, WhatChangesWithTheResultIsTheSessionAndItsPictures) {
  const std::vector<Report> reports = {test::MakeReport()};
  LeftOut left_out;
  left_out.views = {"0002"};
  const auto frames = ResultFrames({session_, detections_, reports, left_out});
  EXPECT_THAT(Topics(frames), testing::ElementsAre("session", "image/sigma/rgb"));
  EXPECT_EQ(Header(frames, "session").at("left_out").at("views"), json({"0002"}));
}

TEST_F(SessionFramesTest, TheFusedCloudIsThinned) {
  const Cloud cloud = test::MakeCloud();
  std::size_t hits = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) hits += cloud.IsHit(i) ? 1 : 0;
  ASSERT_GT(hits, 5U);
  options_.points = 5;
  options_.other_points = 6;  // 2 of each of the three
  const std::vector<NamedFrame> frames = Frames();
  EXPECT_EQ(Parse(frames.at(frames.size() - 2).bytes).arrays.at("points").size(), 2U * 32);
  const ParsedFrame frame = Parse(frames.back().bytes);
  EXPECT_EQ(frame.header.at("count"), hits);
  EXPECT_EQ(frame.header.at("whole"), true);
  EXPECT_EQ(frame.header.at("sweep_end"), true);
  EXPECT_EQ(frame.header.at("calibrated"), json({true, true}));
  EXPECT_EQ(frame.arrays.at("points").size(), 5U * 32);
}

TEST_F(SessionFramesTest, AViewThatCannotBeReadSaysWhyAndTheOthersHaveTheirClouds) {
  std::filesystem::remove(dir_ / "views/0003/cloud.pcd");
  const std::vector<NamedFrame> frames = Frames();
  const json views = Header(frames, "session").at("views");
  for (const json& camera : views.at(2).at("cameras")) {
    EXPECT_EQ(camera.at("state"), "rejected");
    EXPECT_THAT(camera.at("why").get<std::string>(), HasSubstr("cloud.pcd"));
  }
  EXPECT_EQ(views.at(1).at("cameras").at(0).at("state"), "waiting");
  EXPECT_THAT(Topics(frames), testing::Not(testing::Contains(HasSubstr("image/0003"))));
  EXPECT_EQ(frames.back().topic, "cloud/0002");
}

}  // namespace
}  // namespace rgbdt
