#include <filesystem>
#include <vector>

#include "calib/files/atomic_file.h"
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
