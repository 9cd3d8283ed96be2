#include "calib/present/report/report_table.h"

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

// The line that begins with `label`; empty where there is none.
std::string LineOf(const std::string& table, const std::string& label) {
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(label, 0) == 0) return line;
  }
  return "";
}

TEST(ReportTable, HasTheUncertaintyOfThePoseAndOfTheReprojection) {
  Report report = MakeReport();
  CameraReport& camera = report.cameras[0];
  camera.calibration.covariance = Matrix6d((Vector6d() << 2e-4, 1e-4, 1e-4, 4e-4, 3e-4, 3e-4)
                                               .finished()
                                               .array()
                                               .square()
                                               .matrix()
                                               .asDiagonal());
  camera.sigma = PoseSigma{{}, {}, {{2, 0.3, 0.7}, {5, 0.12, 0.61}}};
  const std::string table = ReportTable(report);
  EXPECT_THAT(LineOf(table, "1 sigma, worst axis"), HasSubstr("0.011 deg 0.4 mm"));
  EXPECT_THAT(LineOf(table, "reprojection at 5 m, 1 sigma"), HasSubstr("0.12 / 0.61"));
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 88U) << line;
}

TEST(ReportTable, LeavesOutWhatNobodyWorkedOut) {
  const std::string table = ReportTable(MakeReport());
  EXPECT_THAT(table, Not(HasSubstr("sigma")));
  EXPECT_THAT(table, Not(HasSubstr("next view")));
}

TEST(ReportTable, SaysWhereToHoldTheBoardNext) {
  Report report = MakeReport();
  report.next_view = NextView{"Hold it 6 m ahead.", {}, "rgb", 1, 0.5};
  EXPECT_THAT(ReportTable(report), HasSubstr("next view: Hold it 6 m ahead.\n"));
}

TEST(ReportTable, HasTheStatusOfTheSolveEvenWhereItConverged) {
  Report report = MakeReport();
  report.cameras[0].calibration.status = SolveStatus::kFirstGuessKept;
  report.cameras[0].calibration.detail = "it fits better";
  report.cameras[1].calibration.status = SolveStatus::kDegenerate;
  report.cameras[1].calibration.detail = "parallel boards";
  const std::string table = ReportTable(report);
  EXPECT_THAT(table, HasSubstr("rgb: converged; the first guess was kept: it fits better\n"));
  EXPECT_THAT(table, HasSubstr("thermal: degenerate: parallel boards\n"));
  EXPECT_THAT(ReportTable(MakeReport()), Not(HasSubstr("rgb: converged")));
}

}  // namespace
}  // namespace rgbdt
