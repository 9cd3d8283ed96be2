#include "calib/present/report/report_html.h"

#include "calib/present/report/html.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string HtmlOf(const Report& report) { return ReportHtml(ContentOf(report), {}); }

TEST(ReportHtml, HoldsVerdictFiguresTransformsAndViews) {
  const std::string page = HtmlOf(test::MakeReport());
  for (const char* part :
       {"<!doctype html>", "Camera rgb", "Camera thermal", "0.62\u202fpx", "held out", "rejected",
        "the board is not in view", "camera_from_lidar", "lidar_from_camera", "point_in_camera",
        "30 deg about x, 40 deg about z", "not converged: stopped", "0.100° and 0.3 mm",
        "prefers-color-scheme", "width=device-width", "Computing time"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("http:")));
  EXPECT_THAT(page, Not(HasSubstr("https:")));
}

TEST(ReportHtml, StatesItsUncertainty) {
  const std::string page = HtmlOf(test::MakeReport());
  for (const char* part :
       {"Uncertainty of the pose (1 sigma)", "0.0333°", "0.67\u202fmm",
        "Projection uncertainty (1 sigma)", "50\u202fm", "0.60\u202fpx", "0.97\u202fσ",
        "1 is expected; above 1 the stated sigmas are too small", "1.06\u202fσ", "0001, 0002",
        "Misfit of the first guess", "<td>5.2</td>", "beam edge, no return", "mrad",
        "rgb to thermal", "<strong class=\"good\">✓ no more than the sigmas allow</strong>",
        "Where to hold the board next", "Hold the board 6 m ahead, at the image&#39;s top left.",
        "from 0.88 to 0.09 px"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
}

TEST(ReportHtml, SaysNothingOfWhatNobodyWorkedOut) {
  Report report = test::MakeReport();
  report.cameras.erase(report.cameras.begin());
  report.closure.clear();
  report.next_view.reset();
  const std::string page = HtmlOf(report);
  for (const char* part : {"ncertainty", "1 sigma", "left out", "halves", "besides the pose",
                           "Camera against camera", "Where to hold the board next"}) {
    EXPECT_THAT(page, Not(HasSubstr(part)));
  }
}

TEST(ReportHtml, NothingFromTheReportIsMarkup) {
  const std::string evil = "<b onload=\"x\">&'</b><script>";
  Report report = test::MakeReport();
  report.method = report.rig_hash = evil;
  CameraReport& camera = report.cameras[0];
  camera.calibration.camera = camera.calibration.detail = evil;
  camera.calibration.status = SolveStatus::kNotConverged;
  camera.used[0] = camera.heldout[0] = camera.rejected[0].view = camera.rejected[0].why = evil;
  camera.other_starts[0].start = camera.other_starts[0].calibration.detail = evil;
  camera.nuisance[0].name = camera.nuisance[0].unit = camera.folds[0].heldout[0] = evil;
  report.closure[0].from = report.closure[0].to = evil;
  report.detections[0].view = report.detections[0].cloud_why_not = evil;
  report.detections[0].images[0].camera = report.detections[0].images[0].why_not = evil;
  report.next_view->words = report.next_view->camera = evil;
  const std::string page =
      ReportHtml(ContentOf(report), {{evil, evil, cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3))}});
  EXPECT_THAT(page, Not(HasSubstr("<b ")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("onload=\"x")));
  EXPECT_THAT(page, HasSubstr("&lt;b onload=&quot;x&quot;&gt;&amp;&#39;&lt;/b&gt;"));
}

TEST(ReportHtml, NothingInATextTurnsThePageAbout) {
  EXPECT_EQ(html::Escape("a\nb\tc \u0432\u200f \x1b\x7f\u0085\u2028\u202e\u2067"),
            "a\nb\tc \u0432\u200f ??????");
}

TEST(ReportHtml, TheVerdictFollowsTheFigures) {
  const auto page = [](auto change) {
    Report report = test::MakeReport();
    report.cameras.pop_back();
    report.cameras[0].other_starts.clear();
    change(&report.cameras[0]);
    return HtmlOf(report);
  };
  EXPECT_THAT(page([](CameraReport*) {}), HasSubstr("Good: no sign that it is wrong."));
  const std::string failed = page([](CameraReport* camera) {
    camera->calibration.status = SolveStatus::kNotConverged;
    camera->calibration.detail = "too few views";
  });
  EXPECT_THAT(failed, HasSubstr("Do not use it."));
  EXPECT_THAT(failed, HasSubstr("did not converge: too few views"));
  EXPECT_THAT(page([](CameraReport* camera) { camera->edge_rms_px.heldout.reset(); }),
              HasSubstr("It was not checked"));
  EXPECT_THAT(page([](CameraReport* camera) { camera->edge_rms_px.heldout = 9; }),
              HasSubstr("clearly worse"));
  const StartResult start = test::MakeReport().cameras[0].other_starts[0];
  EXPECT_THAT(page([&](CameraReport* camera) { camera->other_starts = {start}; }),
              HasSubstr("fits worse"));
  EXPECT_THAT(page([&](CameraReport* camera) {
                camera->other_starts = {start};
                camera->other_starts[0].distance_transform_px = 1.3;
              }),
              HasSubstr("the result depends on the start"));
  EXPECT_THAT(page([](CameraReport* camera) { camera->used.resize(2); }),
              HasSubstr("only 2; take 5"));
}

TEST(ReportHtml, LidarsBesideTheReferenceAreInThePage) {
  Report report = test::MakeReport();
  EXPECT_THAT(HtmlOf(report), Not(HasSubstr("LIDARs beside the reference")));
  LidarReport& lidar = report.lidars.emplace_back();
  lidar.calibration.lidar = "rear<b>";
  lidar.calibration.reference_from_lidar.translation = {-0.3, 0.35, 0.2};
  lidar.calibration.status = SolveStatus::kConverged;
  lidar.sigma = LidarSigma{{0.01, 0.02, 0.03}, {0.4, 0.5, 0.6}};
  lidar.nuisance = {{"range offset", "mm", {3.5, 0.6}}};
  lidar.rejected = {{"0002", "the board moved"}};
  const std::string page = HtmlOf(report);
  EXPECT_THAT(page, HasSubstr("LIDARs beside the reference: reference_from_lidar"));
  EXPECT_THAT(page, HasSubstr("rear&lt;b&gt;"));
  EXPECT_THAT(page, HasSubstr("-0.3000, 0.3500, 0.2000 m"));
  EXPECT_THAT(page, HasSubstr("0.0100, 0.0200, 0.0300"));
  EXPECT_THAT(page, HasSubstr("view 0002 is not used: the board moved."));
}

TEST(ReportHtml, PicturesAreInThePage) {
  const std::string page = ReportHtml(
      ContentOf(test::MakeReport()),
      {{"Overlay", "Edges", cv::Mat::zeros(3, 5, CV_8UC3)}, {"None", "Nothing to see", cv::Mat()}});
  EXPECT_THAT(page, HasSubstr("<img alt=\"Overlay\" width=\"5\" height=\"3\" "
                              "src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(page, HasSubstr("Nothing to see"));
}

TEST(ReportHtml, AnEmptyReportIsAPageToo) {
  EXPECT_THAT(HtmlOf(Report{}), HasSubstr("No camera could be calibrated."));
}

TEST(Html, Base64AsInRfc4648) {
  EXPECT_EQ(html::Base64(""), "");
  EXPECT_EQ(html::Base64("f"), "Zg==");
  EXPECT_EQ(html::Base64("fo"), "Zm8=");
  EXPECT_EQ(html::Base64("foo"), "Zm9v");
  EXPECT_EQ(html::Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(html::Base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace rgbdt
