#include <filesystem>
#include <vector>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class SetAside : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    WriteFileAtomically(dir_ / name, text);
  }
  // What it holds; empty: not there.
  std::string Read(const std::string& name) const {
    return std::filesystem::exists(dir_ / name) ? ReadWholeFile(dir_ / name) : "";
  }
  test::TempDir dir_;
};

TEST_F(SetAside, ResultsAreKeptAndNamed) {
  for (const char* name : {"calibration.textproto", "report.json", "report.html", "fused.ply"}) {
    Write(name, name);
  }
  const std::string said = SetResultsAside(dir_.path());
  EXPECT_THAT(said, AllOf(HasSubstr("calibration.previous.textproto, report.previous.json, "
                                    "report.previous.html"),
                          Not(HasSubstr("\n"))));
  EXPECT_EQ(Read("calibration.textproto") + Read("report.json") + Read("report.html"), "");
  EXPECT_EQ(Read("calibration.previous.textproto"), "calibration.textproto");
  EXPECT_EQ(Read("report.previous.json"), "report.json");
  EXPECT_EQ(Read("report.previous.html"), "report.html");
  EXPECT_EQ(Read("fused.ply"), "fused.ply");
}

TEST_F(SetAside, TimingsOfTheSameCamerasAreHandedOn) {
  const Rig rig = test::MakeRig();
  Calibration earlier;
  earlier.method = "sync";
  earlier.sensors = SensorsOf(rig);
  for (const CameraSpec& spec : rig.cameras) {
    CameraCalibration& camera = earlier.cameras.emplace_back();
    camera.camera = spec.name;
    camera.status = SolveStatus::kConverged;
    camera.timing = CameraTiming{{0.0125, 0.001}, {0.02, 0.002}};
  }
  WriteCalibration(dir_ / "calibration.textproto", earlier);
  SetResultsAside(dir_.path());
  Report solved;
  for (const CameraCalibration& camera : earlier.cameras) {
    solved.cameras.emplace_back().calibration.camera = camera.camera;
  }
  const CameraTiming own{{0.5, 0.001}, {0, 0.002}};
  CameraCalibration& first = solved.cameras.front().calibration;
  solved.cameras.back().calibration.timing = own;
  const std::string said = KeepTimings(dir_.path(), rig, &solved);
  EXPECT_THAT(said, AllOf(HasSubstr("`timing` of " + first.camera),
                          HasSubstr("calibration.previous.textproto"), Not(HasSubstr("\n"))));
  EXPECT_EQ(first.timing, earlier.cameras.front().timing);
  EXPECT_EQ(solved.cameras.back().calibration.timing, own) << "its own is newer";

  Rig other = rig;
  other.cameras.front().width *= 2;
  first.timing.reset();
  EXPECT_EQ(KeepTimings(dir_.path(), other, &solved), "");
  EXPECT_FALSE(first.timing);
  EXPECT_EQ(KeepTimings(dir_ / "nowhere", rig, &solved), "");
}

TEST_F(SetAside, NothingIsNothing) {
  EXPECT_EQ(SetResultsAside(dir_ / "nowhere"), "");
  EXPECT_EQ(SetResultsAside(dir_.path()), "");
}

TEST_F(SetAside, TheNewestResultsAreTheOnesThatAreKept) {
  Write("calibration.textproto", "1");
  Write("report.json", "1");
  SetResultsAside(dir_.path());
  Write("calibration.textproto", "2");
  SetResultsAside(dir_.path());
  EXPECT_EQ(Read("calibration.previous.textproto"), "2");
  EXPECT_EQ(Read("report.previous.json"), "") << "of another run than the calibration beside it";
}

TEST_F(SetAside, WhatAFailedRunLeftDoesNotPushAResultOut) {
  Write("calibration.textproto", "good");
  Write("report.json", "good");
  SetResultsAside(dir_.path());
  Write("report.json", "no camera was solved");
  EXPECT_EQ(SetResultsAside(dir_.path()), "");
  EXPECT_EQ(Read("report.json"), "");
  EXPECT_EQ(Read("calibration.previous.textproto"), "good");
  EXPECT_EQ(Read("report.previous.json"), "good");
}

TEST_F(SetAside, AReportAloneIsKeptWhereNothingElseIs) {
  Write("report.json", "of evaluate");
  EXPECT_THAT(SetResultsAside(dir_.path()), HasSubstr("report.previous.json"));
  EXPECT_EQ(Read("report.previous.json"), "of evaluate");
}

}  // namespace
}  // namespace rgbdt
