#include "calib/present/report/intrinsics_html.h"

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

CameraIntrinsics Solved() {
  CameraIntrinsics camera;
  camera.before.name = "rgb";
  camera.before.width = 640;
  camera.before.height = 480;
  camera.corners.views = {{"0001", {{10, 20}, {30, 40}}}, {"<b>", {{1, 2}}}};
  IntrinsicsResult& result = camera.result;
  result.converged = true;
  result.names = {"fx", "fy", "cx", "cy", "k1"};
  result.values = {500.125, 501, 320, 240, -0.25};
  result.covariance = Eigen::MatrixXd::Identity(5, 5) * 0.04;
  result.rms_px = 0.1;
  result.corners_used = 1;
  result.coverage.corners.assign(48, 1);
  result.coverage.fraction = 1;
  IntrinsicsViewFit used;
  used.name = "0001";
  used.used = {true, false};
  used.residuals_px = {{0.1, 0}, {5, 0}};
  IntrinsicsViewFit rejected;
  rejected.name = "<b>";
  rejected.rejected = "RMS 2.3 px, 8 times the median of the views";
  result.views = {used, rejected};
  return camera;
}

TEST(IntrinsicsHtml, ShowsParametersCornersAndEveryView) {
  const std::string page = IntrinsicsHtml({Solved()});
  for (const char* part : {"500.125", "0.200", "-0.250000", "Converged", "100% of the image",
                           "x1=\"10.0\" y1=\"20.0\"", "cx=\"30.0\" cy=\"40.0\"", "8 times"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(page, Not(HasSubstr("<b>")));
  EXPECT_THAT(page, Not(HasSubstr("extrapolated")));
  EXPECT_EQ(page, IntrinsicsHtml({Solved()}));
}

TEST(IntrinsicsHtml, WhatDidNotConvergeHasNoNumbersToUse) {
  CameraIntrinsics camera = Solved();
  camera.result.converged = false;
  camera.result.detail = "not enough tilt";
  camera.result.coverage.corners[0] = camera.result.coverage.corners[1] = 0;
  camera.result.coverage.corners[8] = camera.result.coverage.corners[9] = 0;
  const std::string page = IntrinsicsHtml({camera});
  EXPECT_THAT(page, HasSubstr("Not converged"));
  EXPECT_THAT(page, HasSubstr("not enough tilt"));
  EXPECT_THAT(page, HasSubstr("at the image&#39;s top left: the lens"));
  EXPECT_THAT(page, Not(HasSubstr("500.125")));
}

}  // namespace
}  // namespace rgbdt
