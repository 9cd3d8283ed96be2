#include "calib/files/report_file.h"

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportFile, GivesBackEveryFigure) {
  const test::TempDir dir;
  const Report report = test::MakeReport();
  WriteReport(dir / "report.json", report);
  const Report back = ReadReport(dir / "report.json");
  ASSERT_EQ(back.cameras.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraReport& a = report.cameras[i];
    const CameraReport& b = back.cameras[i];
    EXPECT_EQ(b.calibration.camera, a.calibration.camera);
    test::ExpectSame(b.calibration.camera_from_lidar, a.calibration.camera_from_lidar);
    EXPECT_EQ(b.calibration.covariance, a.calibration.covariance);
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
                          "\"converged\": true",
                          "\"status\": \"converged\"",
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
  camera.calibration.converged = false;
  camera.rejected.clear();
  const std::string json = ReportToJson(report);
  EXPECT_THAT(json, Not(HasSubstr("truth_error")));
  EXPECT_THAT(json, Not(HasSubstr("first_guess_error")));
  EXPECT_THAT(json, Not(HasSubstr("covariance")));
  EXPECT_THAT(json, Not(HasSubstr("NaN")));
  EXPECT_THAT(json, HasSubstr("\"distance_transform_px\": {}"));
  EXPECT_THAT(json, HasSubstr("\"converged\": false"));
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
