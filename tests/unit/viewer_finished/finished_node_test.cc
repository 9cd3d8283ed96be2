#include "viewer/finished/finished_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/methods/calibrate.h"
#include "calib/model/errors.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/present/frames/frame_testing.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt::viewer {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Posts : public Outbox {
 public:
  void Send(Post post) override { all.push_back(std::move(post)); }
  void Forget(const std::string&) override {}

  json Header(const std::string& topic) const {
    for (auto post = all.rbegin(); post != all.rend(); ++post) {
      if (post->topic == topic) return Parse(post->make()).header;
    }
    ADD_FAILURE() << "no post " << topic;
    return {};
  }

  std::vector<Post> all;
};

Image Blank(const CameraSpec& camera, Utime utime) {
  Image image;
  image.camera = camera.name;
  image.utime = utime;
  image.format = camera.format;
  image.pixels = cv::Mat(camera.height, camera.width,
                         camera.kind == CameraKind::kThermal ? CV_16UC1 : CV_8UC1, cv::Scalar(90));
  return image;
}

// Eight views whose boards are known, with blank images and a small cloud each.
class FinishedNodeTest : public ::testing::Test {
 protected:
  FinishedNodeTest() {
    SolveWorldOptions options;
    options.views = 8;
    SolveWorld world(options);
    world.rig.lidar.name = "lidar";
    world.rig.cameras[0].format = PixelFormat::kMono8;
    world.rig.cameras[1].format = PixelFormat::kMono16;
    WriteRig(dir_.path(), world.rig);
    for (const ViewDetection& detection : world.detections) {
      View view;
      view.name = detection.view;
      view.cloud = test::MakeCloud();
      for (const CameraSpec& camera : world.rig.cameras) {
        view.images.push_back(Blank(camera, view.cloud.sweep_utime));
      }
      WriteView(dir_.path(), view);
    }
    session_ = OpenSession(dir_.path());
    detections_ = world.detections;
    report_ = Calibrate(session_.rig, detections_, {});
    node_ = std::make_unique<FinishedNode>(session_, detections_, report_);
    node_->PostTo(&posts_, "a session");
  }

  void LeaveOut(const std::vector<std::string>& views) {
    posts_.all.clear();
    node_->OnBrowser({{"type", "leave_out"}, {"views", views}});
  }

  test::TempDir dir_;
  Session session_;
  std::vector<ViewDetection> detections_;
  Report report_;
  Posts posts_;
  std::unique_ptr<FinishedNode> node_;
};

TEST_F(FinishedNodeTest, PostsTheSessionWithoutCloudsWhichComeWhenAskedFor) {
  const json session = posts_.Header("session");
  EXPECT_EQ(session.at("views").size(), 8U);
  EXPECT_THAT(session.at("left_out").at("views"), IsEmpty());
  EXPECT_EQ(session.at("left_out").at("why_not"), "");
  EXPECT_THAT(session.at("cameras").at(0).at("projection"), Not(IsEmpty()));
  for (const Post& post : posts_.all) EXPECT_THAT(post.topic, Not(HasSubstr("cloud/")));
  const std::string view = session_.views[2];
  const auto answer = node_->OnBrowser({{"type", "view"}, {"view", view}});
  ASSERT_EQ(answer.size(), 1U);
  const json cloud = Parse(answer[0].make()).header;
  EXPECT_EQ(cloud.at("type"), "cloud");
  EXPECT_EQ(cloud.at("view"), view);
  EXPECT_GT(cloud.at("count"), 0);
}

TEST_F(FinishedNodeTest, AViewThatIsLeftOutChangesTheResultAndTakenBackItIsAsBefore) {
  const json before = posts_.Header("session");
  const std::string out = session_.views[3];
  LeaveOut({out});
  const json without = posts_.Header("session");
  EXPECT_EQ(without.at("left_out").at("views"), json({out}));
  EXPECT_EQ(without.at("views").at(3).at("left_out"), true);
  EXPECT_EQ(without.at("views").at(2).at("left_out"), false);
  EXPECT_NE(without.at("cameras").at(0).at("camera_from_lidar"),
            before.at("cameras").at(0).at("camera_from_lidar"));
  const json& moved = without.at("left_out").at("moved");
  ASSERT_EQ(moved.size(), session_.rig.cameras.size());
  EXPECT_GT(moved.at(0).at("rotation_deg"), 0);
  EXPECT_GT(moved.at(0).at("centre_mm"), 0);
  EXPECT_GT(moved.at(0).at("sigmas"), 0);
  EXPECT_LT(moved.at(0).at("sigmas"), 6);
  const std::string overlay = "overlay/" + session_.views[0] + "/" + session_.rig.cameras[0].name;
  EXPECT_EQ(posts_.Header(overlay).at("calibrated"), true);

  LeaveOut({});
  const json back = posts_.Header("session");
  EXPECT_EQ(back.at("cameras"), before.at("cameras"));
  EXPECT_THAT(back.at("left_out").at("moved"), IsEmpty());
}

TEST_F(FinishedNodeTest, NothingIsWritten) {
  LeaveOut({session_.views[0]});
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(dir_.path())) {
    files.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(files, ::testing::UnorderedElementsAre("rig.textproto", "views"));
}

TEST_F(FinishedNodeTest, WhatCannotBeDoneIsSaidAndChangesNothing) {
  EXPECT_THROW(LeaveOut({"0099"}), InputError);
  EXPECT_THROW(LeaveOut(session_.views), InputError);
  EXPECT_THROW(node_->OnBrowser({{"type", "view"}, {"view", "0099"}}), InputError);
  EXPECT_THAT(posts_.all, IsEmpty());
}

TEST_F(FinishedNodeTest, OfAnotherMethodNoViewIsLeftOut) {
  report_.method = "paper";
  FinishedNode node(session_, detections_, report_);
  node.PostTo(&posts_, "a session");
  EXPECT_THAT(posts_.Header("session").at("left_out").at("why_not").get<std::string>(),
              HasSubstr("paper"));
  EXPECT_THROW(node.OnBrowser({{"type", "leave_out"}, {"views", {session_.views[0]}}}), InputError);
}

}  // namespace
}  // namespace rgbdt::viewer
