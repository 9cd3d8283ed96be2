#include "viewer/live/live_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/errors.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt::viewer {
namespace {

using nlohmann::json;
using test::ErrorOf;
using test::TinyRig;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// The header of a frame, as protocol.ts lays it out.
json HeaderOf(const std::string& frame) {
  std::uint32_t size = 0;
  for (int i = 0; i < 4; ++i) {
    size |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(frame.at(4 + i))) << (8 * i);
  }
  return json::parse(frame.substr(8, size));
}

class Posts : public Outbox {
 public:
  void Send(Post post) override { all.push_back(std::move(post)); }
  void Forget(const std::string& prefix) override { forgotten.push_back(prefix); }

  const Post* Newest(const std::string& topic) const {
    for (auto post = all.rbegin(); post != all.rend(); ++post) {
      if (post->topic == topic) return &*post;
    }
    return nullptr;
  }
  json Header(const std::string& topic) const {
    const Post* post = Newest(topic);
    return post == nullptr ? json() : HeaderOf(post->make());
  }
  std::vector<std::string> Topics() const {
    std::vector<std::string> topics;
    for (const Post& post : all) topics.push_back(post.topic);
    return topics;
  }

  std::vector<Post> all;
  std::vector<std::string> forgotten;
};

class LiveNodeTest : public ::testing::Test {
 protected:
  LiveNodeTest() {
    node_.PostTo(&posts_);
    node_.Handle(test::TextOf(TinyRig()));
  }

  // The newest state of the session.
  json State() {
    node_.Advance(now_ += 200'000);
    return posts_.Header("session");
  }
  SessionCommand Capture(const std::string& view, Utime sweep) const {
    SessionCommand command;
    command.verb = SessionVerb::kCapture;
    command.command = 5;
    command.utime = sweep + kMicrosecondsPerSecond;
    command.view = view;
    command.sweep_utime = sweep;
    return command;
  }
  // All that a view is made of.
  void TakeView(const std::string& view, Utime sweep) {
    node_.Handle(test::SweepOfTwo(sweep));
    node_.Handle(Capture(view, sweep));
    for (const CameraSpec& camera : TinyRig().cameras) {
      node_.Handle(test::Blank(camera, sweep + kMicrosecondsPerSecond));
    }
  }
  void SessionRuns(bool by_request, bool busy = false) {
    Status status = test::Ready("session");
    status.counters = {{"by request", by_request}, {"busy", busy}, {"waits for pose", 0}};
    node_.Handle(status);
  }
  void Said(EventKind kind, const std::string& source, const std::string& text,
            double fraction = 0) {
    SessionEvent event;
    event.kind = kind;
    event.source = source;
    event.text = text;
    event.fraction = fraction;
    node_.Handle(event);
  }

  Posts posts_;
  LiveNode node_;
  Utime now_ = 0;
};

TEST_F(LiveNodeTest, TheRigIsPostedOnce) {
  EXPECT_EQ(posts_.Header("rig").at("hash"), TinyRig().hash);
  EXPECT_EQ(posts_.Header("rig").at("cameras").size(), 2U);
  const std::size_t before = posts_.all.size();
  node_.Handle(test::TextOf(TinyRig()));
  EXPECT_EQ(posts_.all.size(), before);
}

TEST_F(LiveNodeTest, AViewIsShownWithItsImagesAndCanBeLookedAt) {
  TakeView("0001", test::kStart);
  EXPECT_THAT(posts_.Topics(), Contains("thumb/0001/rgb"));
  EXPECT_THAT(posts_.Topics(), Contains("thumb/0001/thermal"));
  const json views = State().at("views");
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views[0].at("name"), "0001");
  EXPECT_EQ(views[0].at("cameras")[0].at("image_utime"), test::kStart + kMicrosecondsPerSecond);

  std::vector<std::string> types;
  for (const Post& post : node_.OnBrowser({{"type", "view"}, {"view", "0001"}})) {
    const json header = HeaderOf(post.make());
    EXPECT_EQ(header.at("view"), "0001");
    types.push_back(header.at("type"));
  }
  EXPECT_THAT(types, ElementsAre("image", "overlay", "image", "overlay"));
  EXPECT_THAT(ErrorOf([&] {
                node_.OnBrowser({{"type", "view"}, {"view", "7"}});
              }),
              HasSubstr("no view 7"));
}

TEST_F(LiveNodeTest, AViewThatWaitsSaysForWhat) {
  node_.Handle(Capture("0001", test::kStart));
  node_.Handle(test::Blank(TinyRig().cameras[0], test::kStart + kMicrosecondsPerSecond));
  EXPECT_THAT(State().at("views")[0].at("waits"), HasSubstr("an image of camera thermal"));
}

// A script may ask for a person's picks: the image must be there to pick in before the view is.
TEST_F(LiveNodeTest, AnImageThatWaitsForPicksCanBeLookedAt) {
  SessionCommand capture = Capture("0001", test::kStart);
  capture.picked_cameras = {"thermal"};
  node_.Handle(capture);
  for (const CameraSpec& camera : TinyRig().cameras) {
    node_.Handle(test::Blank(camera, capture.utime));
  }
  const json state = State();
  ASSERT_EQ(state.at("pick_wanted").size(), 1U);
  EXPECT_EQ(state.at("pick_wanted")[0].at("camera"), "thermal");
  EXPECT_EQ(state.at("pick_wanted")[0].at("image_utime"), capture.utime);
  EXPECT_THAT(node_.OnBrowser({{"type", "view"}, {"view", "0001"}}), Not(IsEmpty()));
}

// Picks had it looked at again; the report of before still says why it was rejected.
TEST_F(LiveNodeTest, AViewThatIsLookedAtAgainIsWhatTheDetectorSaysNow) {
  TakeView("0001", test::kStart);
  ViewDetection detection;
  detection.view = "0001";
  detection.images = {{"rgb", test::kStart, std::nullopt, "too dark", 0},
                      {"thermal", test::kStart, std::nullopt, "no checkerboard", 0}};
  detection.cloud.candidates.resize(1);
  node_.Handle(detection);
  json view = State().at("views")[0];
  EXPECT_EQ(view.at("cameras")[0].at("why"), "too dark");
  EXPECT_EQ(view.at("cameras")[1].at("why"), "no checkerboard");
  Report report;
  report.cameras.resize(2);
  report.cameras[0].calibration.camera = "rgb";
  report.cameras[0].rejected = {{"0001", "too dark"}};
  report.cameras[1].calibration.camera = "thermal";
  report.cameras[1].rejected = {{"0001", "no checkerboard"}, {"0002", "too far"}};
  report.method = "auto";
  node_.Handle(ReportText{0, test::kStart, ReportToJson(report)});
  detection.images[0] = {"rgb", test::kStart, ImageEdges(), "", 0};
  detection.images[1].why_not = "board moved 6 mm";
  node_.Handle(detection);
  view = State().at("views")[0];
  EXPECT_EQ(view.at("cameras")[0].at("state"), "accepted");
  EXPECT_EQ(view.at("cameras")[1].at("why"), "board moved 6 mm");
}

TEST_F(LiveNodeTest, TheBoardInTheCloudIsShownWhereTheImagesFailed) {
  TakeView("0001", test::kStart);
  EXPECT_EQ(posts_.Newest("thumb/0001/"), nullptr);
  ViewDetection detection;
  detection.view = "0001";
  for (const CameraSpec& camera : TinyRig().cameras) {
    detection.images.push_back({camera.name, test::kStart, std::nullopt, "no checkerboard", 0});
  }
  CloudEdges board;
  board.centre = {3, 0, 0};
  board.normal = {-1, 0, 0};
  board.width_m = 1.2;
  board.height_m = 0.9;
  detection.cloud.candidates = {board};
  node_.Handle(detection);
  EXPECT_EQ(posts_.Header("thumb/0001/").at("view"), "0001");
  const json view = State().at("views")[0];
  EXPECT_EQ(view.at("board").at("distance_m"), 3.0);
  EXPECT_EQ(view.at("cloud_why_not"), "");
  for (const json& camera : view.at("cameras")) EXPECT_EQ(camera.at("state"), "rejected");
}

TEST_F(LiveNodeTest, AResetForgetsTheViews) {
  TakeView("0001", test::kStart);
  SessionCommand reset;
  reset.verb = SessionVerb::kReset;
  node_.Handle(reset);
  EXPECT_THAT(State().at("views"), IsEmpty());
  EXPECT_THAT(posts_.forgotten, Contains("thumb/"));
}

CalibrationMessage Calibrated(const std::string& camera, double angle, Utime utime) {
  CalibrationMessage message;
  message.utime = utime;
  message.rig_hash = TinyRig().hash;
  message.method = "auto";
  message.calibration.camera = camera;
  message.calibration.camera_from_lidar = RotationAbout({0, 0, 1}, angle);
  message.calibration.covariance = Matrix6d::Identity() * 1e-6;
  message.calibration.status = SolveStatus::kConverged;
  return message;
}

TEST_F(LiveNodeTest, AViewIsLeftOutByTheSolverAndThePoseThatFollowsIsComparedToTheOneBefore) {
  TakeView("0001", test::kStart);
  TakeView("0002", test::kStart + 20 * kMicrosecondsPerSecond);
  node_.Handle(Calibrated("rgb", 0, test::kStart));
  const json ask = {{"type", "leave_out"}, {"views", {"0002"}}};
  EXPECT_THAT(ErrorOf([&] { node_.OnBrowser(ask); }), HasSubstr("rgbdt-solver"));
  EXPECT_THAT(State().at("left_out").at("why_not").get<std::string>(), HasSubstr("rgbdt-solver"));
  node_.Handle(test::Ready("solver"));
  EXPECT_EQ(State().at("left_out").at("why_not"), "");
  node_.OnBrowser(ask);
  const Messages said = node_.Advance(now_ += 200'000);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(std::get<LeftOutViews>(said[0]).views, ElementsAre("0002"));
  json state = State();
  EXPECT_EQ(state.at("views").at(1).at("left_out"), true);
  EXPECT_THAT(state.at("left_out").at("moved"), IsEmpty()) << "not solved yet";
  node_.Handle(Calibrated("rgb", 2e-3, test::kStart));
  state = State();
  const json& moved = state.at("left_out").at("moved").at(0);
  EXPECT_EQ(moved.at("camera"), "rgb");
  EXPECT_NEAR(moved.at("rotation_deg"), 2e-3 * 180 / M_PI, 1e-9);
  EXPECT_NEAR(moved.at("sigmas"), 2, 1e-3);
  node_.Handle(LeftOutViews());  // another browser took it back
  state = State();
  EXPECT_THAT(state.at("left_out").at("views"), IsEmpty());
  EXPECT_THAT(state.at("left_out").at("moved"), IsEmpty());
}

TEST_F(LiveNodeTest, OnlyViewsOfTheSessionAndNotAllOfThemAreLeftOut) {
  TakeView("0001", test::kStart);
  node_.Handle(test::Ready("solver"));
  const auto error = [&](const std::vector<std::string>& views) {
    return ErrorOf([&] { node_.OnBrowser({{"type", "leave_out"}, {"views", views}}); });
  };
  EXPECT_THAT(error({"0009"}), HasSubstr("not in the session"));
  EXPECT_THAT(error({"0001"}), HasSubstr("all views"));
}

TEST_F(LiveNodeTest, WhatABrowserAsksForGoesToTheBus) {
  const json request = {{"type", "request"}, {"request", "capture"}, {"heldout", true}};
  EXPECT_THAT(ErrorOf([&] { node_.OnBrowser(request); }), HasSubstr("rgbdt-session"));
  EXPECT_TRUE(node_.Advance(0).empty());
  SessionRuns(true);
  node_.OnBrowser(request);
  node_.OnBrowser({{"type", "pick"},
                   {"camera", "thermal"},
                   {"image_utime", test::kStart},
                   {"corners", {{1.5, 2}, {30, 2}, {30, 20}, {1, 20}}}});
  const Messages said = node_.Advance(1);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(std::get<SessionRequest>(said[0]).request, SessionRequestKind::kCapture);
  EXPECT_TRUE(std::get<SessionRequest>(said[0]).heldout);
  EXPECT_EQ(std::get<CornerSelection>(said[1]).image_utime, test::kStart);
  EXPECT_EQ(std::get<CornerSelection>(said[1]).corners[0], Eigen::Vector2d(1.5, 2));
  EXPECT_TRUE(node_.Advance(2).empty());
  EXPECT_THAT(ErrorOf([&] {
                node_.OnBrowser({{"type", "pick"},
                                 {"camera", "front"},
                                 {"image_utime", 1},
                                 {"corners", {{1, 2}, {3, 2}, {3, 4}, {1, 4}}}});
              }),
              HasSubstr("front"));
}

TEST_F(LiveNodeTest, WhatMayBeAskedForFollowsTheSession) {
  EXPECT_EQ(State().at("mode"), "none");
  SessionRuns(false);
  EXPECT_EQ(State().at("mode"), "script");
  EXPECT_THAT(State().at("can"), IsEmpty());
  SessionRuns(true);
  EXPECT_EQ(State().at("mode"), "by_hand");
  EXPECT_EQ(State().at("can"), json({"capture"}));
  Said(EventKind::kProgress, "session", "view 0001: asked for a sweep");
  Said(EventKind::kProgress, "simulator", "sweeping", 0.5);
  json state = State();
  EXPECT_EQ(state.at("busy"), "view 0001: asked for a sweep: sweeping");
  EXPECT_EQ(state.at("fraction"), 0.5);
  EXPECT_THAT(state.at("can"), IsEmpty());
  Said(EventKind::kFailed, "session", "the motor is stuck");
  state = State();
  EXPECT_EQ(state.at("busy"), "");
  EXPECT_EQ(state.at("failure"), "the motor is stuck");
  EXPECT_EQ(state.at("can"), json({"capture"}));
  now_ += 100 * kMicrosecondsPerSecond;
  EXPECT_EQ(State().at("mode"), "none") << "it was not heard for long";
}

RgbdtCloud Fused(Utime sweep, bool whole, bool end) {
  RgbdtCloud cloud;
  cloud.sweep_utime = sweep;
  cloud.whole_sweep = whole;
  cloud.sweep_end = end;
  cloud.points = {{4, 0, 0}};
  cloud.intensity = {0.5F};
  cloud.utime = {sweep};
  cloud.rgb = {{1, 2, 3}};
  cloud.temperature_k = cloud.temperature_sigma_k = cloud.thermal_counts = {NAN};
  cloud.valid = {0};
  return cloud;
}

TEST_F(LiveNodeTest, ChunksPassByAndWholeSweepsAreKeptPartByPart) {
  node_.Handle(Fused(1000, false, false));
  EXPECT_FALSE(posts_.all.back().kept);
  EXPECT_TRUE(posts_.all.back().heavy);
  EXPECT_EQ(posts_.all.back().watch, "cloud");
  node_.Handle(Fused(1000, true, false));
  node_.Handle(Fused(1000, true, true));
  EXPECT_EQ(posts_.Header("sweep/0").at("part"), 0);
  EXPECT_EQ(posts_.Header("sweep/1").at("part"), 1);
  EXPECT_TRUE(posts_.Newest("sweep/1")->kept);
  posts_.forgotten.clear();
  node_.Handle(Fused(2000, true, true));
  EXPECT_EQ(posts_.Header("sweep/0").at("sweep_utime"), 2000);
  EXPECT_THAT(posts_.forgotten, ElementsAre("sweep/"));
}

TEST_F(LiveNodeTest, AnImageThatIsNotTheRigsIsRefused) {
  Image small = test::Blank(TinyRig().cameras[0], test::kStart);
  small.pixels = cv::Mat(10, 20, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(ErrorOf([&] { node_.Handle(small); }), HasSubstr("20x10"));
  EXPECT_EQ(posts_.Newest("image/rgb"), nullptr);
}

TEST_F(LiveNodeTest, ACalibrationOfAnotherRigIsRefused) {
  CalibrationMessage message;
  message.utime = test::kStart;
  message.rig_hash = "0123456789abcdef";
  message.calibration.camera = "rgb";
  message.calibration.status = SolveStatus::kConverged;
  EXPECT_THAT(ErrorOf([&] { node_.Handle(message); }),
              ::testing::AllOf(HasSubstr("0123456789abcdef"), HasSubstr(TinyRig().hash)));
  EXPECT_EQ(State().at("cameras")[0].at("calibrated"), false);
  message.rig_hash = TinyRig().hash;
  node_.Handle(message);
  EXPECT_EQ(State().at("cameras")[0].at("calibrated"), true);
  // A new rig: what was made with the one before is no longer shown.
  Rig other = TinyRig();
  other.cameras[0].lens.fx += 10;
  const std::string text = PrintRig(other);
  node_.Handle(RigText{0, HashOfRigText(text), text});
  EXPECT_EQ(State().at("cameras")[0].at("calibrated"), false);
  EXPECT_THAT(ErrorOf([&] { node_.Handle(message); }), HasSubstr("camera rgb: pinhole.fx: "));
}

TEST_F(LiveNodeTest, SigmaIsCountedByTheViewsUsed) {
  for (int view = 1; view <= 3; ++view) {
    ViewDetection detection;
    detection.view = "000" + std::to_string(view);
    detection.heldout = view == 2;
    detection.images = {{"rgb", test::kStart, ImageEdges(), "", 0}};
    detection.cloud.candidates.resize(1);
    node_.Handle(detection);
    CalibrationMessage message;
    message.rig_hash = TinyRig().hash;
    message.utime = test::kStart + view;
    message.calibration.camera = "rgb";
    message.calibration.covariance = Matrix6d::Identity() * 1e-8 / view;
    node_.Handle(message);
    node_.Handle(message);  // as it comes again at 1 Hz
  }
  const json sigma = State().at("sigma");
  ASSERT_EQ(sigma.size(), 2U);
  EXPECT_EQ(sigma[0].at("views"), 1);
  EXPECT_EQ(sigma[1].at("views"), 2);
  EXPECT_LT(sigma[1].at("cameras")[0].at("rotation_deg"),
            sigma[0].at("cameras")[0].at("rotation_deg"));
}

TEST_F(LiveNodeTest, TheBusIsPostedOnceASecondWithTheProcessesThatWereHeard) {
  node_.PostBus([](double now_s) { return json{{"type", "bus"}, {"at", now_s}}; });
  SessionRuns(true);
  for (const Utime now : {0, 999'999, 1'000'000}) node_.Advance(now);
  const auto topics = posts_.Topics();
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "bus"), 2);
  EXPECT_EQ(posts_.Header("bus").at("at"), 1.0);
  EXPECT_EQ(posts_.Header("bus").at("processes")[0].at("process"), "session");
}

TEST_F(LiveNodeTest, TargetStatusSaysWhoSeesTheBoard) {
  TargetStatus status;
  status.camera = "thermal";
  status.utime = test::kStart;
  status.seen = true;
  status.text = "3.1 m away";
  node_.Handle(status);
  status.camera = "";
  node_.Handle(status);
  const json sensors = posts_.Header("target_status").at("sensors");
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_EQ(sensors[0].at("sensor"), "lidar");
  EXPECT_EQ(sensors[1].at("kind"), "thermal");
  EXPECT_EQ(sensors[1].at("text"), "3.1 m away");
}

TEST(LiveNode, WhatComesBeforeTheRigHarmsNothing) {
  Posts posts;
  LiveNode node;
  node.PostTo(&posts);
  CalibrationMessage calibration;
  calibration.calibration.camera = "rgb";
  calibration.calibration.status = SolveStatus::kConverged;
  calibration.calibration.covariance = Matrix6d::Identity();
  node.Handle(calibration);
  WaveProgress wave;
  wave.clocks = {{"stranger", std::nullopt, ""}};
  node.Handle(wave);
  node.Handle(test::Blank(TinyRig().cameras[0], test::kStart));
  EXPECT_EQ(posts.Newest("image/" + TinyRig().cameras[0].name), nullptr) << "of whatever name";
  node.Advance(kMicrosecondsPerSecond);
  EXPECT_NE(posts.Newest("session"), nullptr);
  EXPECT_EQ(posts.Header("wave").at("phase"), "waiting");
  EXPECT_TRUE(posts.Header("wave").at("cameras").empty());
}

TEST_F(LiveNodeTest, AWavedBoardIsPostedAndThatItWentWithoutAWord) {
  WaveProgress wave;
  wave.phase = WavePhase::kRecording;
  wave.clocks = {{"rgb", Estimate{0.01, 0.001}, ""}};
  node_.Advance(kMicrosecondsPerSecond);
  EXPECT_EQ(posts_.Newest("wave"), nullptr);
  node_.Handle(wave);
  node_.Advance(2 * kMicrosecondsPerSecond);
  EXPECT_EQ(posts_.Header("wave").at("phase"), "recording");
  EXPECT_EQ(posts_.Header("wave").at("cameras")[0].at("camera"), "rgb");
  node_.Advance(20 * kMicrosecondsPerSecond);
  EXPECT_EQ(posts_.Header("wave").at("phase"), "failed");
  wave.clocks[0].camera = "stranger";
  EXPECT_THROW(node_.Handle(wave), InputError);
}

TEST_F(LiveNodeTest, MountsHaveALampAndAHistory) {
  MountCheck check;
  check.camera = "thermal";
  check.utime = test::kStart;
  check.text = "2 of 3 sweeps seen";
  node_.Handle(check);  // of which nothing is told yet
  for (int i = 1; i <= 3; ++i) {
    check.utime = test::kStart + i * kMicrosecondsPerSecond;
    check.state = i < 3 ? MountState::kHolds : MountState::kMoved;
    check.holds = i < 3 ? 0.99 : 0.001;
    check.moved[1] = 0.001 * i;
    check.text = "turned";
    node_.Handle(check);
  }
  node_.Advance(0);
  const json cameras = posts_.Header("mounts").at("cameras");
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].at("camera"), "thermal");
  EXPECT_EQ(cameras[0].at("state"), "moved");
  EXPECT_EQ(cameras[0].at("holds"), 0.001);
  EXPECT_EQ(cameras[0].at("text"), "turned");
  ASSERT_EQ(cameras[0].at("steps").size(), 3U);
  EXPECT_NEAR(cameras[0].at("steps")[2].at("rotation_deg"), 0.003 * 180 / M_PI, 1e-9);
  // The clock is set back: what came before is no history of this.
  check.utime = test::kStart;
  check.holds.reset();
  check.state = MountState::kCannotTell;
  node_.Handle(check);
  node_.Advance(2 * kMicrosecondsPerSecond);
  const json after = posts_.Header("mounts").at("cameras")[0];
  EXPECT_TRUE(after.at("holds").is_null());
  EXPECT_TRUE(after.at("steps").empty());
  check.camera = "stranger";
  EXPECT_THROW(node_.Handle(check), InputError);
}

}  // namespace
}  // namespace rgbdt::viewer
