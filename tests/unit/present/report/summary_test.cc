#include "calib/present/report/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Report MakeReport() {
  Report report;
  report.method = "auto";
  for (const char* name : {"rgb", "thermal"}) {
    CameraReport camera;
    camera.calibration.camera = name;
    camera.calibration.status = SolveStatus::kConverged;
    report.cameras.push_back(camera);
  }
  return report;
}

std::string FullReport(const Report& report) { return Summary(report).FullReport(); }

// The line that begins with `label`; empty where there is none.
std::string LineOf(const std::string& table, const std::string& label) {
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(label, 0) == 0) return line;
  }
  return "";
}

TEST(Summary, HasTheUncertaintyOfThePoseAndOfTheProjection) {
  Report report = MakeReport();
  CameraReport& camera = report.cameras[0];
  camera.calibration.covariance = Matrix6d((Vector6d() << 2e-4, 1e-4, 1e-4, 4e-4, 3e-4, 3e-4)
                                               .finished()
                                               .array()
                                               .square()
                                               .matrix()
                                               .asDiagonal());
  camera.sigma = PoseSigma{{}, {}, {{2, 0.3, 0.7}, {5, 0.12, 0.61}, {50, 0.1, 0.5}}};
  for (CameraReport& good : report.cameras) {
    good.edge_rms_px = {0.5, 0.5};
    good.used.resize(8);
  }
  const std::string table = FullReport(report);
  EXPECT_THAT(LineOf(table, "1 sigma, worst axis"), HasSubstr("0.011 deg 0.4 mm"));
  EXPECT_THAT(LineOf(table, "worst projection at 2/5/10 m, 1 sigma"), HasSubstr("0.70 / 0.61 / -"));
  std::istringstream lines(table.substr(table.find("method ")));  // below the verdicts
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 88U) << line;
}

TEST(Summary, HasWhenACameraSeesWhereThatIsKnown) {
  Report report = MakeReport();
  EXPECT_EQ(LineOf(FullReport(report), "time offset"), "");
  report.cameras[1].calibration.timing = CameraTiming{{-0.0123, 5e-5}, {0.02, 1.4e-5}};
  const std::string table = FullReport(report);
  EXPECT_THAT(LineOf(table, "time offset"), HasSubstr(" -      -12.300 +- 0.050"));
  EXPECT_THAT(LineOf(table, "read-out"), HasSubstr(" 20.000 +- 0.014"));
}

TEST(Summary, HasALineForEachLidarBesideTheReference) {
  Report report = MakeReport();
  LidarReport& lidar = report.lidars.emplace_back();
  lidar.calibration.lidar = "rear";
  lidar.calibration.reference_from_lidar.translation = {-0.3, 0.35, 0.2};
  lidar.calibration.status = SolveStatus::kConverged;
  lidar.calibration.covariance = Matrix6d::Identity() * 1e-8;
  lidar.used.resize(7);
  lidar.rejected = {{"0002", "the board moved"}};
  lidar.truth_error = PoseError{0.0123, 0.94};
  const std::string text = FullReport(report);
  EXPECT_THAT(LineOf(text, "LIDAR rear: converged; 7 views used, 1 not"),
              HasSubstr("at -0.3000, 0.3500, 0.2000 m; 1 sigma, worst axis: 0.0057 deg"));
  EXPECT_THAT(text, HasSubstr("against truth: 0.0123 deg 0.94 mm"));
  EXPECT_THAT(text, HasSubstr("the board moved"));
  EXPECT_TRUE(Summary(report).converged());
  lidar.calibration.status = SolveStatus::kNotSolved;
  EXPECT_FALSE(Summary(report).converged());
  EXPECT_THAT(LineOf(FullReport(report), "LIDAR rear: not calibrated"), Not(HasSubstr("deg")));
}

TEST(Summary, LeavesOutWhatNobodyWorkedOut) {
  const std::string table = FullReport(MakeReport());
  EXPECT_THAT(table, Not(HasSubstr("sigma")));
  EXPECT_THAT(table, Not(HasSubstr("next view")));
}

TEST(Summary, SaysWhereToHoldTheBoardNext) {
  Report report = MakeReport();
  report.next_view = NextView{"Hold it 6 m ahead.", {}, "rgb", 1, 0.5};
  EXPECT_THAT(FullReport(report), HasSubstr("next view: Hold it 6 m ahead.\n"));
}

TEST(Summary, HasTheStatusOfTheSolveEvenWhereItConverged) {
  Report report = MakeReport();
  report.cameras[0].calibration.status = SolveStatus::kFirstGuessKept;
  report.cameras[0].calibration.detail = "it fits better";
  report.cameras[1].calibration.status = SolveStatus::kDegenerate;
  report.cameras[1].calibration.detail = "parallel boards";
  const std::string table = FullReport(report);
  EXPECT_THAT(table, HasSubstr("rgb: converged; the first guess was kept: it fits better\n"));
  EXPECT_EQ(LineOf(table, "thermal: degenerate"), "") << "its verdict has it";
  EXPECT_THAT(FullReport(MakeReport()), Not(HasSubstr("rgb: converged")));
}

TEST(Summary, InALineSaysHowEachCamerasSolveEnded) {
  Report report = MakeReport();
  report.cameras[0].sigma = PoseSigma{{}, {}, {{5, 0.12, 0.61}}};
  report.cameras[0].distance_transform_px = {8.6, 21.9};  // nothing of this method's
  EXPECT_EQ(Summary(report).BriefReport(),
            "rgb: converged, 0.61 px at 5 m (1 sigma); thermal: converged");
  EXPECT_THAT(FullReport(report), Not(HasSubstr("distance transform")));
}

TEST(Summary, OfThePapersMethodInALineHasTheDistanceTransform) {
  Report report = MakeReport();
  report.method = "paper";
  report.cameras[0].distance_transform_px = {0.514, 0.626};
  report.cameras[1].calibration.status = SolveStatus::kNotSolved;
  report.cameras[1].calibration.detail = "2 usable views";
  EXPECT_EQ(Summary(report).BriefReport(),
            "rgb: converged, 0.51 px, 0.63 px on held-out views; "
            "thermal: not calibrated: 2 usable views");
}

TEST(Summary, IsConvergedWhereAllCamerasAre) {
  Report report = MakeReport();
  EXPECT_TRUE(Summary(report).converged());
  report.cameras[1].calibration.status = SolveStatus::kFirstGuessKept;
  EXPECT_TRUE(Summary(report).converged());
  report.cameras[1].calibration.status = SolveStatus::kDegenerate;
  EXPECT_FALSE(Summary(report).converged());
}

TEST(Summary, SaysOnceWhyViewsWereRejected) {
  Report report = MakeReport();
  for (CameraReport& camera : report.cameras) {
    camera.rejected = {{"0001", "no board in the cloud"},
                       {"0002", "no board in the cloud"},
                       {"0003", "cannot read 0003/rgb.png"}};
    camera.warnings = {"rings scatter"};
  }
  EXPECT_THAT(FullReport(report),
              HasSubstr("rgb, thermal: 2 views rejected (0001, 0002), 0001: no board in the cloud\n"
                        "rgb, thermal: view 0003 rejected: cannot read 0003/rgb.png\n"
                        "rgb, thermal: rings scatter\n"));
  EXPECT_THAT(Summary(report).FullReport({"cannot read 0003/rgb.png"}), Not(HasSubstr("0003")));
}

// How often the text stands in the other.
int Times(const std::string& text, const std::string& in) {
  int times = 0;
  for (auto at = in.find(text); at != std::string::npos; at = in.find(text, at + 1)) ++times;
  return times;
}

TEST(Summary, SaysAReasonOnce) {
  Report report = MakeReport();
  report.next_view = NextView{"Hold it 6 m ahead.", {}, "rgb", 1, 0.5};
  CameraReport& rgb = report.cameras[0];
  const auto text = [&] { return FullReport(report); };
  rgb.calibration.status = SolveStatus::kNotSolved;
  rgb.calibration.detail = "0 usable views";
  rgb.rejected = {{"0001", "clouds in mm"}, {"0002", "clouds in mm"}};
  EXPECT_EQ(Times("clouds in mm", text()), 1);
  EXPECT_EQ(Times("0 usable views", text()), 1);
  report.cameras[1].rejected = rgb.rejected;  // its verdict does not say it
  EXPECT_THAT(text(),
              HasSubstr("rgb, thermal: 2 views rejected (0001, 0002), 0001: clouds in mm\n"));
  report.cameras[1].rejected.clear();
  rgb.rejected.clear();
  rgb.calibration.detail = "the images are mirrored";
  EXPECT_EQ(Times("the images are mirrored", text()), 1);
  rgb.calibration.status = SolveStatus::kDegenerate;
  EXPECT_EQ(Times("the images are mirrored", text()), 1);
  EXPECT_EQ(Times("Hold it 6 m ahead", text()), 1);
  rgb.calibration.status = SolveStatus::kContradicted;
  rgb.causes = {{"squares", "the squares are too large", 100, 1, 10}};
  rgb.calibration.detail = "Likeliest cause: the squares are too large.";
  EXPECT_EQ(Times("the squares are too large", text()), 1);
  EXPECT_THAT(LineOf(text(), "status"), HasSubstr("NOT TO BE USED"));
}

TEST(Summary, SaysWhatSpeaksAgainstTheResult) {
  Report report = MakeReport();
  report.cameras[1].view_scatter = ViewScatter{9, 20};
  EXPECT_THAT(FullReport(report),
              HasSubstr("thermal: Doubtful: something does not fit together. The views scatter 3.0 "
                        "times"));
}

}  // namespace
}  // namespace rgbdt
