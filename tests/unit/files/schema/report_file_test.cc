#include "calib/files/schema/report_file.h"

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportFile, GivesBackEveryFigure) {
  const test::TempDir dir;
  Report report = test::MakeReport();
  report.cameras[1].calibration.range_errors = test::MakeRangeErrors();
  report.cameras[1].calibration.timing = CameraTiming{{0.0125, 1e-5}, {-0.02, 2e-5}};
  WriteReport(dir / "report.json", report);
  const Report back = ReadReport(dir / "report.json");
  ASSERT_EQ(back.cameras.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraReport& a = report.cameras[i];
    const CameraReport& b = back.cameras[i];
    EXPECT_EQ(b.calibration.camera, a.calibration.camera);
    test::ExpectSame(b.calibration.camera_from_lidar, a.calibration.camera_from_lidar);
    EXPECT_EQ(b.calibration.covariance, a.calibration.covariance);
    EXPECT_TRUE(b.calibration.range_errors == a.calibration.range_errors);
    EXPECT_EQ(b.calibration.timing, a.calibration.timing);
    ASSERT_EQ(b.first_guess.has_value(), a.first_guess.has_value());
    if (a.first_guess) test::ExpectSame(*b.first_guess, *a.first_guess);
    EXPECT_EQ(b.used, a.used);
    EXPECT_EQ(b.heldout, a.heldout);
    ASSERT_EQ(b.rejected.size(), 1u);
    EXPECT_EQ(b.rejected[0].why, a.rejected[0].why);
    EXPECT_EQ(b.distance_transform_px.heldout, a.distance_transform_px.heldout);
    EXPECT_EQ(b.edge_rms_px.train, a.edge_rms_px.train);
    ASSERT_EQ(b.views.size(), 2u);
    EXPECT_EQ(b.views[1].distance_transform_px, a.views[1].distance_transform_px);
    ASSERT_EQ(b.other_starts.size(), 1u);
    EXPECT_EQ(b.other_starts[0].start, a.other_starts[0].start);
    EXPECT_EQ(b.other_starts[0].calibration.camera, a.calibration.camera);
    EXPECT_EQ(b.other_starts[0].from_result.translation_mm, 700.5);
    EXPECT_EQ(b.truth_error.has_value(), a.truth_error.has_value());
    EXPECT_EQ(b.solve_s, a.solve_s);
  }
  EXPECT_EQ(back.cameras[1].truth_error->translation_mm, 1.0 / 3);
  // int64 as a JSON number would lose its last digits in most readers.
  EXPECT_EQ(back.utime, report.utime);
  EXPECT_EQ(ReportToJson(back), ReportToJson(report));
}

TEST(ReportFile, GivesBackHowSureItIs) {
  Report report = test::MakeReport();
  report.cameras[0].variance_factor = 2.25;
  report.cameras[0].view_scatter = ViewScatter{1.5, 20};
  report.cameras[0].contradiction = "friday puts this camera elsewhere";
  report.cameras[0].cannot_tell = "all sweeps turned the same way";
  const Report back = ReportFromJson(ReportToJson(report));
  const CameraReport& a = report.cameras[0];
  const CameraReport& b = back.cameras[0];
  EXPECT_EQ(b.variance_factor, a.variance_factor);
  EXPECT_EQ(b.contradiction, a.contradiction);
  EXPECT_EQ(b.cannot_tell, a.cannot_tell);
  ASSERT_EQ(b.view_scatter.has_value(), a.view_scatter.has_value());
  if (a.view_scatter) {
    EXPECT_EQ(b.view_scatter->factor, a.view_scatter->factor);
    EXPECT_EQ(b.view_scatter->freedom, a.view_scatter->freedom);
  }
  EXPECT_EQ(b.edge_rms_whitened.train, a.edge_rms_whitened.train);
  EXPECT_EQ(b.edge_rms_whitened.heldout, a.edge_rms_whitened.heldout);
  EXPECT_FALSE(b.views[0].edge_rms_whitened);
  EXPECT_EQ(b.views[1].edge_rms_whitened, a.views[1].edge_rms_whitened);
  EXPECT_FALSE(b.views[0].edge_rms_mm || b.views[0].plane_rms_mm);
  EXPECT_EQ(b.views[1].edge_rms_mm, 1.0 / 11);
  EXPECT_EQ(b.views[1].plane_rms_mm, 1.0 / 13);
  EXPECT_EQ(b.edge_rms_mm.heldout, 1.0 / 17);
  EXPECT_EQ(b.plane_rms_mm.heldout, 1.0 / 19);
  ASSERT_TRUE(b.sigma);
  EXPECT_EQ(b.sigma->rotation_deg, a.sigma->rotation_deg);
  EXPECT_EQ(b.sigma->centre_mm, a.sigma->centre_mm);
  ASSERT_EQ(b.sigma->colouring.size(), 4U);
  EXPECT_EQ(b.sigma->colouring[3].distance_m, 50);
  EXPECT_EQ(b.sigma->colouring[3].centre_px, 0.25);
  EXPECT_EQ(b.sigma->colouring[3].worst_px, 2.0 / 3);
  ASSERT_EQ(b.nuisance.size(), 2U);
  EXPECT_EQ(b.nuisance[1].name, "board's thickness");
  EXPECT_EQ(b.nuisance[1].unit, "mm");
  EXPECT_EQ(b.nuisance[1].estimate.value, 1.0 / 7);
  EXPECT_EQ(b.nuisance[1].estimate.sigma, 3);
  ASSERT_EQ(b.folds.size(), 2U);
  EXPECT_EQ(b.folds[0].heldout, a.folds[0].heldout);
  EXPECT_EQ(b.folds[1].edge_rms_whitened, 0.91);
  EXPECT_EQ(b.folds[1].misfit, 1.0 / 9);
  EXPECT_EQ(b.folds[1].first_guess_misfit, 0.93);
  EXPECT_EQ(b.folds[1].expected_misfit, a.folds[1].expected_misfit);
  EXPECT_EQ(b.folds[1].from_result.rotation_deg, 0.005);
  EXPECT_EQ(b.folds[1].from_result.translation_mm, 0.105);
  ASSERT_TRUE(b.halves);
  EXPECT_EQ(b.halves->difference.translation_mm, 1.0 / 3);
  EXPECT_EQ(b.halves->chi2, 5.25);
  ASSERT_TRUE(b.edges_planes);
  EXPECT_EQ(b.edges_planes->difference.translation_mm, 1.0 / 7);
  EXPECT_EQ(b.edges_planes->chi2, 6.75);
  EXPECT_EQ(b.edges_planes->sigma_enlarged, 1.5);
  EXPECT_FALSE(b.halves->sigma_enlarged);
  EXPECT_FALSE(b.scene);
}

TEST(ReportFile, GivesBackWhatASceneWithoutATargetSaid) {
  Report report = test::MakeReport();
  report.cameras[0].scene = SceneCheck{4321, 1.0 / 6, 1.0 / 21, std::nullopt};
  const Report back = ReportFromJson(ReportToJson(report));
  ASSERT_TRUE(back.cameras[0].scene);
  const SceneCheck& scene = *back.cameras[0].scene;
  EXPECT_EQ(scene.edges, 4321);
  EXPECT_EQ(scene.shown, 1.0 / 6);
  EXPECT_EQ(scene.heldout_start, 1.0 / 21);
  EXPECT_FALSE(scene.heldout_result);
}

TEST(ReportFile, GivesBackWhatItSaysOfTheWholeRig) {
  const Report report = test::MakeReport();
  const Report back = ReportFromJson(ReportToJson(report));
  ASSERT_EQ(back.closure.size(), 1U);
  const Closure& closure = back.closure[0];
  EXPECT_EQ(closure.from, "rgb");
  EXPECT_EQ(closure.to, "thermal");
  test::ExpectSame(closure.by_lidar, report.closure[0].by_lidar);
  test::ExpectSame(closure.by_images, report.closure[0].by_images);
  EXPECT_EQ(closure.difference.translation_mm, 1.25);
  EXPECT_EQ(closure.sigma.translation_mm, 1.0 / 6);
  EXPECT_EQ(closure.chi2, 7.5);
  ASSERT_TRUE(back.next_view);
  EXPECT_EQ(back.next_view->words, report.next_view->words);
  EXPECT_EQ(back.next_view->camera, "thermal");
  test::ExpectSame(back.next_view->lidar_from_target, report.next_view->lidar_from_target);
  EXPECT_EQ(back.next_view->sigma_before_px, 0.875);
  EXPECT_EQ(back.next_view->sigma_after_px, 1.0 / 11);
}

TEST(ReportFile, GivesBackWhatWasDetectedInImageAndCloud) {
  const Report report = test::MakeReport();
  const std::string json = ReportToJson(report);
  const Report back = ReportFromJson(json);
  ASSERT_EQ(back.detections.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const DetectedView& a = report.detections[i];
    const DetectedView& b = back.detections[i];
    EXPECT_EQ(b.view, a.view);
    EXPECT_EQ(b.heldout, a.heldout);
    ASSERT_EQ(b.images.size(), 2U);
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(b.images[c].camera, a.images[c].camera);
      EXPECT_EQ(b.images[c].why_not, a.images[c].why_not);
    }
    EXPECT_EQ(b.cloud_candidates, a.cloud_candidates);
    EXPECT_EQ(b.cloud_why_not, a.cloud_why_not);
  }
  for (const char* text : {"\"why_not\": \"no checkerboard\"", "\"why_not\": \"too dark\"",
                           "\"cloud_candidates\": 0", "\"cloud_why_not\": \"no plane\""}) {
    EXPECT_THAT(json, HasSubstr(text));
  }
  // A hostile name or reason is text.
  Report hostile = report;
  hostile.detections[2].cloud_why_not = "plane\xff\"";
  EXPECT_EQ(ReportFromJson(ReportToJson(hostile)).detections[2].cloud_why_not,
            "plane\xEF\xBF\xBD\"");
}

TEST(ReportFile, WhatNobodyWorkedOutIsAbsent) {
  Report report = test::MakeReport();
  report.cameras.erase(report.cameras.begin());
  report.closure.clear();
  report.next_view.reset();
  const std::string json = ReportToJson(report);
  for (const char* key : {"edge_rms_whitened", "sigma\"", "halves", "next_view", "NaN"}) {
    EXPECT_THAT(json, Not(HasSubstr(key)));
  }
  const Report back = ReportFromJson(json);
  EXPECT_FALSE(back.cameras[0].sigma);
  EXPECT_FALSE(back.cameras[0].halves);
  EXPECT_FALSE(back.cameras[0].edge_rms_whitened.train);
  EXPECT_TRUE(back.cameras[0].nuisance.empty());
  EXPECT_TRUE(back.cameras[0].folds.empty());
  EXPECT_TRUE(back.closure.empty());
  EXPECT_FALSE(back.next_view);
}

TEST(ReportFile, NumbersThatAreNotFiniteAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  Report report = test::MakeReport();
  CameraReport& camera = report.cameras[0];
  (*camera.calibration.covariance)(2, 3) = infinite;
  camera.views[1].edge_rms_whitened = nan;
  camera.edge_rms_whitened = {nan, infinite};
  camera.sigma->rotation_deg[1] = nan;
  camera.sigma->colouring[0].centre_px = nan;
  camera.nuisance[0].estimate.sigma = infinite;
  camera.folds[0].misfit = nan;
  camera.folds[0].from_result.rotation_deg = nan;
  camera.halves->chi2 = infinite;
  report.closure[0].chi2 = nan;
  report.closure.push_back(report.closure[0]);
  report.closure[1].by_images.translation.x() = nan;
  report.next_view->sigma_before_px = infinite;
  const std::string json = ReportToJson(report);
  EXPECT_THAT(json, Not(HasSubstr("NaN")));
  EXPECT_THAT(json, Not(HasSubstr("Infinity")));
  const Report back = ReportFromJson(json);
  const CameraReport& read = back.cameras[0];
  EXPECT_FALSE(read.calibration.covariance);
  EXPECT_FALSE(read.views[1].edge_rms_whitened);
  EXPECT_FALSE(read.edge_rms_whitened.heldout);
  EXPECT_TRUE(std::isnan(read.sigma->rotation_deg[0]));  // all three or none
  EXPECT_EQ(read.sigma->centre_mm, camera.sigma->centre_mm);
  EXPECT_TRUE(std::isnan(read.sigma->colouring[0].centre_px));
  EXPECT_EQ(read.sigma->colouring[0].worst_px, 0.7);
  EXPECT_TRUE(std::isnan(read.nuisance[0].estimate.sigma));
  EXPECT_TRUE(std::isnan(read.folds[0].misfit));
  EXPECT_TRUE(std::isnan(read.folds[0].from_result.rotation_deg));
  EXPECT_TRUE(std::isnan(read.halves->chi2));
  ASSERT_EQ(back.closure.size(), 1U);
  EXPECT_TRUE(std::isnan(back.closure[0].chi2));
  EXPECT_TRUE(std::isnan(back.next_view->sigma_before_px));
  EXPECT_EQ(ReportToJson(back), json);
}

TEST(ReportFile, ThreeAxesAreThreeNumbers) {
  std::string json = ReportToJson(test::MakeReport());
  const std::size_t at = json.find("\"centre_mm\": [");
  ASSERT_NE(at, std::string::npos);
  json.insert(json.find('[', at) + 1, "1, ");
  const std::string error = test::ErrorOf([&] { ReportFromJson(json, "report.json"); });
  EXPECT_THAT(error, HasSubstr("report.json: camera \"rgb\""));
  EXPECT_THAT(error, HasSubstr("centre_mm"));
}

TEST(ReportFile, TheNewPartsHaveTheirUnitsInTheirNames) {
  const std::string json = ReportToJson(test::MakeReport());
  std::size_t at = 0;
  for (const char* key : {"\"rgb\": {",
                          "\"edge_rms_whitened\": 1.0625",
                          "\"edge_rms_whitened\": {",
                          "\"sigma\": {",
                          "\"rotation_deg\": [",
                          "\"centre_mm\": [",
                          "\"colouring\": [",
                          "\"distance_m\": 2",
                          "\"centre_px\": 0.3",
                          "\"worst_px\": 0.7",
                          "\"nuisance\": [",
                          "\"name\": \"beam edge, no return\"",
                          "\"unit\": \"mrad\"",
                          "\"estimate\": {",
                          "\"folds\": [",
                          "\"heldout\": [",
                          "\"misfit\": 1.02",
                          "\"first_guess_misfit\": 1.03",
                          "\"from_result\": {",
                          "\"halves\": {",
                          "\"difference\": {",
                          "\"translation_mm\": 0.33",
                          "\"chi2\": 5.25",
                          "\"closure\": [",
                          "\"from\": \"rgb\"",
                          "\"to\": \"thermal\"",
                          "\"to_from_from_by_lidar\": {",
                          "\"to_from_from_by_images\": {",
                          "\"next_view\": {",
                          "\"words\": \"Hold",
                          "\"lidar_from_target\": {",
                          "\"sigma_before_px\": 0.875",
                          "\"sigma_after_px\": 0.09"}) {
    const std::size_t found = json.find(key, at);
    ASSERT_NE(found, std::string::npos) << key << " is not there, or not in order:\n" << json;
    at = found;
  }
}

TEST(ReportFile, HasTheKeysThatTheIssueNames) {
  Report report = test::MakeReport();
  report.cameras.erase(report.cameras.begin());
  const std::string json = ReportToJson(report);
  std::size_t at = 0;
  for (const char* key : {"\"method\": \"paper\"",
                          "\"cameras\": {",
                          "\"thermal\": {",
                          "\"camera_from_lidar\": {",
                          "\"quaternion_wxyz\": [",
                          "\"translation_m\": [",
                          "\"status\": \"CONVERGED\"",
                          "\"detail\": \"\"",
                          "\"views\": {",
                          "\"used\": [",
                          "\"heldout\": [",
                          "\"rejected\": [",
                          "\"view\": \"0006\"",
                          "\"why\": \"the board is not in view\"",
                          "\"distance_transform_px\": {",
                          "\"train\": 1.25",
                          "\"heldout\": 0.3333333333333333",
                          "\"edge_rms_px\": {",
                          "\"train\": 0.5",
                          "\"heldout\": 0.625",
                          "\"first_guess_error\": {",
                          "\"rotation_deg\": 2.5",
                          "\"translation_mm\": 50.125",
                          "\"truth_error\": {",
                          "\"rotation_deg\": 0.1",
                          "\"seconds\": {",
                          "\"detect_image\": 1.5",
                          "\"detect_cloud\": 0.25",
                          "\"solve\": 0.125"}) {
    const std::size_t found = json.find(key, at);
    ASSERT_NE(found, std::string::npos) << key << " is not there, or not in order:\n" << json;
    at = found;
  }
}

TEST(ReportFile, WhatIsUnknownIsAbsentAndZeroIsPrinted) {
  Report report = test::MakeReport();
  report.cameras.pop_back();
  CameraReport& camera = report.cameras[0];
  camera.calibration.covariance.reset();
  camera.distance_transform_px = {};
  camera.edge_rms_px.heldout = std::numeric_limits<double>::quiet_NaN();
  camera.views.clear();
  camera.other_starts.clear();
  camera.calibration.status = SolveStatus::kNotSolved;
  camera.rejected.clear();
  const std::string json = ReportToJson(report);
  EXPECT_THAT(json, Not(HasSubstr("truth_error")));
  EXPECT_THAT(json, Not(HasSubstr("first_guess_error")));
  EXPECT_THAT(json, Not(HasSubstr("covariance")));
  EXPECT_THAT(json, Not(HasSubstr("NaN")));
  EXPECT_THAT(json, HasSubstr("\"distance_transform_px\": {}"));
  EXPECT_THAT(json, HasSubstr("\"status\": \"NOT_SOLVED\""));
  EXPECT_THAT(json, HasSubstr("\"rejected\": []"));
  const Report back = ReportFromJson(json);
  EXPECT_FALSE(back.cameras[0].truth_error);
  EXPECT_FALSE(back.cameras[0].distance_transform_px.train);
  EXPECT_FALSE(back.cameras[0].edge_rms_px.heldout);
}

TEST(ReportFile, TheSameReportGivesTheSameBytesWhateverTheOrderOfCameras) {
  Report report = test::MakeReport();
  for (const char* name : {"b", "zz", "a", "m", "k", "x1", "x2", "x3"}) {
    report.cameras.push_back(report.cameras[0]);
    report.cameras.back().calibration.camera = name;
  }
  const std::string json = ReportToJson(report);
  std::reverse(report.cameras.begin(), report.cameras.end());
  EXPECT_EQ(ReportToJson(report), json);
  EXPECT_EQ(ReportFromJson(json).cameras.front().calibration.camera, "a");
}

TEST(ReportFile, BytesThatAreNotUtf8AreReplaced) {
  Report report = test::MakeReport();
  report.cameras[0].used[0] = "view\xff";
  EXPECT_EQ(ReportFromJson(ReportToJson(report)).cameras[0].used[0], "view\xEF\xBF\xBD");
}

TEST(ReportFile, ErrorsNameTheFileAndTheKey) {
  const test::TempDir dir;
  WriteFileAtomically(dir / "report.json", "{\"methud\": \"paper\"}");
  const std::string error = test::ErrorOf([&] { ReadReport(dir / "report.json"); });
  EXPECT_THAT(error, HasSubstr("report.json"));
  EXPECT_THAT(error, HasSubstr("methud"));
  EXPECT_THAT(test::ErrorOf([] { ReportFromJson("{\"cameras\": {\"rgb\": {}}}"); }),
              HasSubstr("camera \"rgb\""));
}

TEST(ReportFile, DamagedJsonNeverCrashes) {
  const std::string json = ReportToJson(test::MakeReport());
  const auto parse = [](const std::string& text) { ReportFromJson(text); };
  test::ParseTruncations(json, parse);
  test::ParseDamaged(json, parse);
  test::ErrorOf([&] { parse(std::string(100'000, '[')); });
  test::ErrorOf([&] { parse(""); });
}

}  // namespace
}  // namespace rgbdt
