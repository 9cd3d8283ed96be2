#include "calib/present/frames/session_state.h"

#include "calib/camera/camera.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/present/layout/frame.h"
#include "calib/present/report/report_content.h"
#include "calib/solve/colouring.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/present/frames/frame_testing.h"

namespace rgbdt {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json SessionJson(const SessionState& state, const Rig* rig) {
  return Parse(SessionFrame(state, rig)).header;
}

ImageDetection FoundBy(const std::string& camera) {
  ImageEdges edges;
  edges.outline_corners = {Eigen::Vector2d(1, 2), Eigen::Vector2d(9, 2.5), Eigen::Vector2d(9, 8),
                           Eigen::Vector2d(1, 8)};
  return {camera, 1000, edges, "", 0};
}

ImageDetection Missed(const std::string& camera) {
  return {camera, 2000, std::nullopt, "no board in the image", 0};
}

CloudDetection FoundInCloud() {
  CloudDetection cloud;
  cloud.candidates.resize(1);
  cloud.candidates[0].centre = {3, 0, 4};
  cloud.candidates[0].normal = {-1, 0, 0};
  return cloud;
}

ViewState ViewOf(const std::string& name, const std::vector<ImageDetection>& images,
                 const CloudDetection& cloud = FoundInCloud()) {
  ViewState view;
  view.name = name;
  view.detection.emplace();
  view.detection->view = name;
  view.detection->images = images;
  view.detection->cloud = cloud;
  for (const ImageDetection& image : images) view.images[image.camera] = image.utime;
  return view;
}

SessionState Finished() {
  SessionState state;
  state.mode = "finished";
  state.report = test::MakeReport();
  state.calibration = state.report->ToCalibration();
  for (const char* camera : {"rgb", "thermal"}) state.calibration_utime[camera] = test::kNow;
  for (const char* view : {"0001", "0003", "0006"}) {
    state.views.push_back(ViewOf(view, {FoundBy("rgb"), FoundBy("thermal")}));
  }
  return state;
}

TEST(SessionFrame, WithoutAnythingItSaysSo) {
  const json frame = SessionJson({}, nullptr);
  EXPECT_EQ(frame.at("type"), "session");
  EXPECT_EQ(frame.at("mode"), "none");
  for (const char* empty : {"can", "log", "views", "pick_wanted", "sigma", "cameras"}) {
    EXPECT_EQ(frame.at(empty), json::array()) << empty;
  }
  EXPECT_EQ(frame.at("verdict").at("grade"), "none");
  EXPECT_EQ(frame.at("verdict").at("headline"), "No calibration yet");
  EXPECT_TRUE(frame.at("next_view").is_null());
  EXPECT_TRUE(frame.at("report").is_null());
}

TEST(SessionFrame, WhatRunsIsThere) {
  SessionState state;
  state.mode = "script";
  state.can = {"capture", "finish"};
  state.busy = "sweeping";
  state.fraction = 0.25;
  state.step = 3;
  state.steps = 9;
  state.failure = "the motor stopped";
  SessionEvent event;
  event.utime = test::kNow;
  event.source = "detector";
  event.kind = EventKind::kFailed;
  event.text = "no sweep";
  state.log = {event};
  state.sigma = {{4, {{"rgb", {0.1, 2.5}}}}};
  const json frame = SessionJson(state, nullptr);
  EXPECT_EQ(frame.at("can"), json({"capture", "finish"}));
  EXPECT_EQ(frame.at("busy"), "sweeping");
  EXPECT_EQ(frame.at("fraction"), 0.25);
  EXPECT_EQ(frame.at("step"), 3);
  EXPECT_EQ(frame.at("steps"), 9);
  EXPECT_EQ(frame.at("failure"), "the motor stopped");
  EXPECT_EQ(frame.at("log"), json::array({{{"utime", test::kNow},
                                           {"source", "detector"},
                                           {"kind", "failed"},
                                           {"text", "no sweep"}}}));
  EXPECT_EQ(frame.at("sigma").at(0).at("views"), 4);
  EXPECT_EQ(frame.at("sigma").at(0).at("cameras").at(0),
            json({{"camera", "rgb"}, {"rotation_deg", 0.1}, {"centre_mm", 2.5}}));
}

TEST(SessionFrame, ViewsSayWhatWasFoundInThem) {
  const Rig rig = test::MakeRig();
  SessionState state;
  state.views = {ViewOf("0001", {FoundBy("rgb"), Missed("thermal")}),
                 ViewOf("0002", {FoundBy("rgb")}),
                 ViewOf("0003", {FoundBy("rgb"), Missed("thermal")},
                        CloudDetection{{}, "no plane of its size", 0})};
  state.views[1].heldout = true;
  state.views[1].waits = "for thermal";
  const json views = SessionJson(state, &rig).at("views");
  ASSERT_EQ(views.size(), 3U);
  EXPECT_EQ(views[0].at("name"), "0001");
  EXPECT_EQ(
      views[0].at("board"),
      json({{"centre_m", {3.0, 0.0, 4.0}}, {"normal", {-1.0, 0.0, 0.0}}, {"distance_m", 5.0}}));
  const json& rgb = views[0].at("cameras").at(0);
  EXPECT_EQ(rgb.at("camera"), "rgb");
  EXPECT_EQ(rgb.at("state"), "accepted");
  EXPECT_EQ(rgb.at("image_utime"), 1000);
  EXPECT_EQ(rgb.at("outline"), json({{1.0, 2.0}, {9.0, 2.5}, {9.0, 8.0}, {1.0, 8.0}}));
  EXPECT_TRUE(rgb.at("edge_rms_px").is_null());
  const json& thermal = views[0].at("cameras").at(1);
  EXPECT_EQ(thermal.at("state"), "rejected");
  EXPECT_EQ(thermal.at("why"), "no board in the image");
  EXPECT_EQ(thermal.at("outline"), json::array());
  EXPECT_EQ(views[1].at("heldout"), true);
  EXPECT_EQ(views[1].at("waits"), "for thermal");
  EXPECT_EQ(views[1].at("cameras").at(1).at("state"), "waiting");
  // Image and cloud apart.
  EXPECT_EQ(views[0].at("cloud_why_not"), "");
  EXPECT_EQ(rgb.at("image_why_not"), "");
  EXPECT_EQ(thermal.at("image_why_not"), "no board in the image");
  EXPECT_TRUE(views[2].at("board").is_null());
  EXPECT_EQ(views[2].at("cloud_why_not"), "no plane of its size");
  EXPECT_EQ(views[2].at("cameras").at(0).at("state"), "rejected");
  EXPECT_EQ(views[2].at("cameras").at(0).at("why"), "no plane of its size");
  EXPECT_EQ(views[2].at("cameras").at(0).at("image_why_not"), "");
  EXPECT_EQ(views[2].at("cameras").at(1).at("why"),
            "image: no board in the image; cloud: no plane of its size");
}

TEST(SessionFrame, TheBoardInTheCloudIsShownWhereEveryImageFailed) {
  const Rig rig = test::MakeRig();
  SessionState state;
  state.views = {ViewOf("0001", {Missed("rgb"), Missed("thermal")})};
  const json view = SessionJson(state, &rig).at("views").at(0);
  EXPECT_EQ(view.at("board").at("distance_m"), 5.0);
  for (const json& camera : view.at("cameras")) EXPECT_EQ(camera.at("state"), "rejected");
}

TEST(SessionFrame, PicksAreWantedWhereAnImageWasLookedAtInVainNewestFirst) {
  const Rig rig = test::MakeRig();
  SessionState state;
  const CloudDetection missed{{}, "no board in the cloud", 0};
  ImageDetection unread = Missed("rgb");
  unread.utime = 0;
  state.views = {ViewOf("0001", {Missed("thermal")}),
                 ViewOf("0002", {Missed("rgb"), FoundBy("thermal")}),
                 ViewOf("0003", {FoundBy("rgb")}, missed),  // corners would not help
                 ViewOf("0004", {unread})};
  const json wanted = SessionJson(state, &rig).at("pick_wanted");
  ASSERT_EQ(wanted.size(), 2U);
  EXPECT_EQ(wanted[0], json({{"view", "0002"},
                             {"camera", "rgb"},
                             {"image_utime", 2000},
                             {"why", "no board in the image"}}));
  EXPECT_EQ(wanted[1].at("view"), "0001");
}

TEST(SessionFrame, BeforeTheFirstSolveItSaysHowManyViewsAreMissing) {
  const Rig rig = test::MakeRig();
  SessionState state;
  for (const char* view : {"0001", "0002", "0003"}) {
    state.views.push_back(ViewOf(view, {FoundBy("rgb"), Missed("thermal")}));
  }
  const json frame = SessionJson(state, &rig);
  EXPECT_EQ(frame.at("verdict").at("grade"), "none");
  EXPECT_EQ(frame.at("verdict").at("headline"), "No calibration yet");
  ASSERT_EQ(frame.at("verdict").at("reasons").size(), 2U);
  EXPECT_THAT(frame.at("verdict").at("reasons").at(0).get<std::string>(),
              HasSubstr("rgb: The board was found in 3 views; take 5 more"));
  EXPECT_THAT(frame.at("verdict").at("reasons").at(1).get<std::string>(),
              HasSubstr("thermal: The board was found in 0 views; take 8 more"));
  const json& rgb = frame.at("cameras").at(0);
  EXPECT_EQ(rgb.at("calibrated"), false);
  EXPECT_EQ(rgb.at("verdict").at("grade"), "none");
  EXPECT_TRUE(rgb.at("camera_from_lidar").is_null());
}

TEST(SessionFrame, AFinishedOneHasFiguresVerdictsAndTheReport) {
  const Rig rig = test::MakeRig();
  const json frame = SessionJson(Finished(), &rig);
  const json& rgb = frame.at("cameras").at(0);
  EXPECT_EQ(rgb.at("calibrated"), true);
  EXPECT_EQ(rgb.at("status"), "converged");
  EXPECT_EQ(rgb.at("utime"), test::kNow);
  EXPECT_EQ(rgb.at("camera_from_lidar").size(), 16U);
  EXPECT_NEAR(rgb.at("camera_from_lidar").at(7).get<double>(), 0.2, 1e-12);
  EXPECT_TRUE(frame.at("cameras").at(1).at("rotation_sigma_deg").is_null());
  const json& views = frame.at("views");
  EXPECT_EQ(views[0].at("cameras").at(0).at("edge_rms_px"), 0.5);
  EXPECT_TRUE(views[0].at("cameras").at(0).at("edge_rms_sigmas").is_null());
  EXPECT_EQ(views[1].at("cameras").at(0).at("edge_rms_sigmas"), 1.0625);
  EXPECT_TRUE(views[0].at("cameras").at(0).at("edge_rms_mm").is_null());
  EXPECT_EQ(views[1].at("cameras").at(0).at("edge_rms_mm"), 1.0 / 11);
  EXPECT_EQ(views[1].at("cameras").at(0).at("plane_rms_mm"), 1.0 / 13);
  // FoundBy, but the solver left it out.
  EXPECT_EQ(views[2].at("cameras").at(0).at("state"), "rejected");
  EXPECT_EQ(views[2].at("cameras").at(0).at("why"), "the board is not in view");
  EXPECT_THAT(frame.at("next_view").at("gain").get<std::string>(),
              HasSubstr("camera thermal is worst"));
  EXPECT_THAT(frame.at("report").at("intro").get<std::string>(), HasSubstr("Method: paper."));
  EXPECT_EQ(frame.at("report").at("cameras").size(), 2U);
}

// The words and tables of the plain HTML page (ReportHtml's tests look at them) reach the page.
TEST(SessionFrame, HasTheReportsTablesAndPoses) {
  const json frame = SessionJson(Finished(), nullptr);
  const ReportContent content = ContentOf(test::MakeReport());
  const json& report = frame.at("report");
  EXPECT_EQ(report.at("intro"), content.intro);
  ASSERT_EQ(report.at("cameras").size(), content.cameras.size());
  const json& camera = report.at("cameras").at(0);
  EXPECT_EQ(camera.at("camera"), "rgb");
  const std::vector<Table>& tables = content.cameras[0].tables;
  ASSERT_EQ(camera.at("tables").size(), tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const json& shown = camera.at("tables").at(i);
    EXPECT_EQ(shown.at("title"), tables[i].title);
    EXPECT_EQ(shown.at("notes"), tables[i].notes);
    EXPECT_EQ(shown.at("head"), tables[i].head);
    ASSERT_EQ(shown.at("rows").size(), tables[i].rows.size());
    for (std::size_t r = 0; r < tables[i].rows.size(); ++r) {
      ASSERT_EQ(shown.at("rows").at(r).size(), tables[i].head.size()) << tables[i].title;
      EXPECT_EQ(shown.at("rows").at(r).at(1).at("text"), tables[i].rows[r][1].text);
    }
  }
  const Rigid3 pose = test::MakeReport().cameras[0].calibration.camera_from_lidar;
  const json& answer = frame.at("cameras").at(0);
  EXPECT_EQ(answer.at("poses").at(0).at("name"), "camera_from_lidar");
  EXPECT_EQ(answer.at("poses").at(0).at("matrix"), MatrixOf(pose));
  EXPECT_EQ(answer.at("poses").at(1).at("name"), "lidar_from_camera");
  EXPECT_EQ(answer.at("poses").at(1).at("matrix"), MatrixOf(pose.Inverse()));
  const json& detected = report.at("tables").at(0);
  EXPECT_EQ(detected.at("title"), "What was found in each view");
  EXPECT_EQ(detected.at("head"), json({"View", "Image of rgb", "Image of thermal", "Cloud"}));
  EXPECT_EQ(detected.at("rows").at(1).at(2).at("text"), "no checkerboard");
  EXPECT_EQ(detected.at("rows").at(1).at(3).at("text"), "board found");
  EXPECT_EQ(detected.at("rows").at(2).at(3).at("text"), "no plane");
  EXPECT_EQ(report.at("tables").at(1).at("title"), "Camera against camera");
}

TEST(SessionFrame, HasTheUncertaintyThatTheTerminalAndTheReportHave) {
  const Rig rig = test::MakeRig();
  SessionState state = Finished();
  CameraCalibration& camera = state.calibration.cameras.at(0);
  camera.covariance = Matrix6d((Vector6d() << 1e-3, 2e-3, 1e-3, 4e-3, 3e-3, 3e-3)
                                   .finished()
                                   .array()
                                   .square()
                                   .matrix()
                                   .asDiagonal());
  state.projection[camera.camera] = ProjectionOf(rig, camera);
  const json shown = SessionJson(state, &rig).at("cameras").at(0);
  EXPECT_NEAR(shown.at("rotation_sigma_deg"), 2e-3 * 180 / M_PI, 1e-9);
  EXPECT_NEAR(shown.at("centre_sigma_mm"), 4, 1e-9);
  const PoseSigma sigma = SigmaOf(rig.cameras[0], camera);
  for (const ColouringSigma& expected : sigma.colouring) {
    const double d = expected.distance_m;
    double worst = 0;
    for (const json& at : shown.at("projection")) {
      const double variance =
          at.at(0).get<double>() + at.at(1).get<double>() / d + at.at(2).get<double>() / (d * d);
      worst = std::max(worst, std::sqrt(variance));
    }
    EXPECT_NEAR(worst, expected.worst_px, 1e-9);
  }
  camera.covariance.reset();
  EXPECT_TRUE(ProjectionOf(rig, camera).empty());
}

TEST(SessionFrame, SaysWhatIsLeftOutAndHowFarThatMovedThePose) {
  SessionState state = Finished();
  ASSERT_FALSE(state.views.empty());
  state.left_out.views = {state.views[0].name};
  state.left_out.moved["rgb"] = {{0.01, 1.5}, 0.8};
  state.left_out.moved["thermal"] = {{0.02, 2.5}, std::nullopt};
  const json frame = SessionJson(state, nullptr);
  EXPECT_EQ(frame.at("views").at(0).at("left_out"), true);
  const json& moved = frame.at("left_out").at("moved");
  EXPECT_EQ(moved.at(0),
            json({{"camera", "rgb"}, {"rotation_deg", 0.01}, {"centre_mm", 1.5}, {"sigmas", 0.8}}));
  EXPECT_TRUE(moved.at(1).at("sigmas").is_null());
}

TEST(SessionFrame, HeldOutViewsAreJudgedCameraByCamera) {
  const Rig rig = test::MakeRig();
  SessionState state = Finished();
  state.report->cameras[1].edge_rms_whitened.heldout.reset();
  const auto judged = [&](double rms) {
    state.report->cameras[0].edge_rms_whitened.heldout = rms;
    return SessionJson(state, &rig).at("heldout").at("rows").at(0).at(3);
  };
  EXPECT_EQ(judged(1.0), json({{"text", "as expected"}, {"mark", "good"}}));
  EXPECT_EQ(judged(1.41), json({{"text", "less exact than stated"}, {"mark", "doubtful"}}));
  EXPECT_EQ(judged(0.69), json({{"text", "more exact than stated"}, {"mark", "usable"}}));
  const json thermal = SessionJson(state, &rig).at("heldout").at("rows").at(1);
  EXPECT_EQ(thermal.at(0).at("text"), "thermal");
  EXPECT_EQ(thermal.at(3), json({{"text", "not judged yet"}, {"mark", "none"}}));
}

// A report of cameras that all are good.
Report GoodReport(const std::vector<std::string>& cameras) {
  Report report = test::MakeReport();
  CameraReport good = report.cameras[0];
  good.other_starts.clear();
  report.cameras.clear();
  for (const std::string& camera : cameras) {
    good.calibration.camera = camera;
    report.cameras.push_back(good);
  }
  return report;
}

json VerdictOfReport(const Report& report) {
  SessionState state;
  state.report = report;
  state.calibration = report.ToCalibration();
  for (const CameraReport& camera : report.cameras) {
    ViewState view;
    view.images[camera.calibration.camera] = 1;
    state.views.push_back(view);
  }
  return SessionJson(state, nullptr).at("verdict");
}

TEST(SessionFrame, TheVerdictOfAllNamesTheCamerasInPlainWords) {
  const json one = VerdictOfReport(GoodReport({"rgb"}));
  EXPECT_EQ(one.at("grade"), "good");
  EXPECT_EQ(one.at("headline"),
            "Camera rgb is calibrated; projection uncertainty at 5 m: up to 0.6 px (1 sigma)");
  Report report = GoodReport({"rgb", "thermal"});
  report.cameras[1].sigma->colouring[1].worst_px = 0.9;
  EXPECT_EQ(VerdictOfReport(report).at("headline"),
            "Both cameras are calibrated; projection uncertainty at 5 m: up to 0.9 px (1 sigma)");
  report.cameras[0].sigma.reset();
  EXPECT_EQ(VerdictOfReport(report).at("headline"), "Both cameras are calibrated");
  EXPECT_EQ(VerdictOfReport(GoodReport({"a", "b", "c"})).at("headline"),
            "All 3 cameras are calibrated; projection uncertainty at 5 m: up to 0.6 px (1 sigma)");
}

TEST(SessionFrame, TheWorstCameraCounts) {
  Report report = GoodReport({"back", "rgb", "thermal"});
  report.cameras[1].used = {"0001"};
  json verdict = VerdictOfReport(report);
  EXPECT_EQ(verdict.at("grade"), "usable");
  EXPECT_EQ(verdict.at("headline"), "Usable: rgb; back and thermal are calibrated");
  report.cameras[2].calibration.status = SolveStatus::kNotConverged;
  verdict = VerdictOfReport(report);
  EXPECT_EQ(verdict.at("grade"), "bad");
  EXPECT_EQ(verdict.at("headline"),
            "Do not use the calibration of thermal; usable: rgb; back is calibrated");
  report.cameras[2].distance_transform_px = {};  // a guess
  report.cameras[2].edge_rms_px = {};
  report.cameras[2].calibration.status = SolveStatus::kNotSolved;
  verdict = VerdictOfReport(report);
  EXPECT_EQ(verdict.at("grade"), "none");
  EXPECT_THAT(verdict.at("headline").get<std::string>(),
              HasSubstr("No calibration yet of thermal; usable: rgb"));
}

TEST(SessionFrame, AReportOfAnotherRigIsRefusedInAPlainSentence) {
  const std::string why = "report.json was made with another rig than rig.textproto; fx: 1 -> 2";
  const json verdict = VerdictOfReport(WithoutPoses(GoodReport({"rgb"}), why));
  EXPECT_EQ(verdict.at("grade"), "bad");
  EXPECT_EQ(verdict.at("headline"), "Do not use the calibration of rgb");
  EXPECT_THAT(verdict.at("reasons").at(0).get<std::string>(), HasSubstr(why));
}

// A script solves at its end: until then each view's calibration is used, and nobody judged it.
TEST(SessionFrame, ACalibrationWithoutAReportIsNotJudgedYet) {
  const Rig rig = test::MakeRig();
  SessionState state;
  for (const CameraSpec& camera : rig.cameras) {
    CameraCalibration calibration;
    calibration.camera = camera.name;
    state.calibration.cameras.push_back(calibration);
  }
  const json verdict = SessionJson(state, &rig).at("verdict");
  EXPECT_EQ(verdict.at("grade"), "none");
  EXPECT_THAT(verdict.at("headline").get<std::string>(),
              testing::StartsWith("Calibrated so far, not judged yet: rgb"));
}

TEST(SessionFrame, HostileNamesAreOnlyText) {
  const std::string evil = "</script><b>\xff\"\\\n";
  Rig rig = test::MakeRig();
  rig.cameras[0].name = evil;
  SessionState state = Finished();
  state.failure = evil;
  state.views[0].name = evil;
  state.views[0].detection->view = evil;
  state.views[0].detection->images = {Missed(evil)};
  state.views[0].detection->images[0].why_not = evil;
  state.views[0].detection->cloud.why_not = evil;
  state.report->cameras[0].calibration.camera = evil;
  state.report->next_view->words = evil;
  const std::string shown = "</script><b>\xEF\xBF\xBD\"\\\n";
  for (const Rig* known : {static_cast<const Rig*>(&rig), static_cast<const Rig*>(nullptr)}) {
    const json frame = SessionJson(state, known);
    EXPECT_EQ(frame.at("failure"), shown);
    EXPECT_EQ(frame.at("views").at(0).at("name"), shown);
    EXPECT_EQ(frame.at("next_view").at("words"), shown);
  }
  EXPECT_EQ(Parse(RigFrame(rig)).header.at("cameras").at(0).at("name"), shown);
}

TEST(RigFrame, HasWhatThePageDraws) {
  Rig rig = test::MakeRig();
  rig.hash = "abc";
  const json frame = Parse(RigFrame(rig)).header;
  EXPECT_EQ(frame.at("hash"), "abc");
  const json& thermal = frame.at("cameras").at(1);
  EXPECT_EQ(thermal.at("name"), "thermal");
  EXPECT_EQ(thermal.at("kind"), "thermal");
  EXPECT_EQ(thermal.at("width"), 24);
  EXPECT_EQ(thermal.at("height"), 18);
  EXPECT_EQ(frame.at("target").at("squares_x"), 11);
  EXPECT_EQ(frame.at("target").at("height_m"), 0.9144);
}

TEST(RigFrame, SaysWhereEachImagesCornersLook) {
  Rig rig = test::MakeRig();
  const Camera camera(rig.cameras[0]);
  const json corners = Parse(RigFrame(rig)).header.at("cameras").at(0).at("corners");
  ASSERT_EQ(corners.size(), 4U);
  const auto pixel = camera.Project({corners[2].at(0).get<double>(), corners[2].at(1).get<double>(),
                                     corners[2].at(2).get<double>()});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), rig.cameras[0].width - 0.5, 1e-6);
  EXPECT_NEAR(pixel->y(), rig.cameras[0].height - 0.5, 1e-6);
  rig.cameras[0].lens = {};
  EXPECT_TRUE(Parse(RigFrame(rig)).header.at("cameras").at(0).at("corners").empty());
}

}  // namespace
}  // namespace rgbdt
