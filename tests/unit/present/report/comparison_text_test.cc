#include "calib/present/report/comparison_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

CalibrationComparison Turned(double deg, double chi2) {
  CalibrationComparison comparison;
  comparison.a = "monday";
  comparison.b = "friday";
  comparison.utime_a = 1'700'000'000'000'000;
  comparison.utime_b = comparison.utime_a + 1;
  PoseComparison& camera = comparison.cameras.emplace_back();
  camera.camera = "rgb";
  for (Estimate& axis : camera.rotation_deg) axis.sigma = 0.08;
  for (Estimate& axis : camera.centre_mm) axis.sigma = 2;
  camera.rotation_deg[1].value = deg;
  camera.difference = {deg, 0};
  camera.chi2 = chi2;
  camera.pixels = {{2, 1.4, 0.6}, {5, 1.3, 0.5}};
  return comparison;
}

TEST(ComparisonText, WithinWhatBothCanTellItIsTheSame) {
  const std::string text = ComparisonText(Turned(0.1, 7.2));
  EXPECT_THAT(text, HasSubstr("friday against monday"));
  EXPECT_THAT(text, HasSubstr("rgb: the same within what both can tell (chi-square 7.2 of 6)"));
  EXPECT_THAT(text, HasSubstr("+0.100 +- 0.080"));
  EXPECT_THAT(text, HasSubstr("colours at 2, 5 m, RMS over the image [px]"));
  EXPECT_THAT(text, HasSubstr("1.40 +- 0.60"));
}

TEST(ComparisonText, OfTheSamePoseWithOtherLensesItSaysSo) {
  CalibrationComparison comparison = Turned(0.1, 7.2);
  comparison.cameras[0].pixels = {{2, 3.0, 1.1}, {5, 33.2, 5.0}, {10, 30, 5.1}};
  EXPECT_TRUE(ColoursMoved(comparison.cameras[0]));
  const std::string text = ComparisonText(comparison);
  EXPECT_THAT(text, HasSubstr("rgb: the same pose within what both can tell (chi-square 7.2 of 6); "
                              "but the lenses differ: colours at 5 m lie 33.2 px apart"));
  EXPECT_THAT(text, HasSubstr("where 5.0 px are stated"));
  comparison.cameras[0].pixels[1].rms_px = 14;
  comparison.cameras[0].pixels[2].sigma_px.reset();  // whatever they are, nothing is stated
  EXPECT_FALSE(ColoursMoved(comparison.cameras[0]));
}

TEST(ComparisonText, BeyondItTheMountMovedAboutAnAxisSinceADay) {
  const std::string text = ComparisonText(Turned(0.42, 27.6));
  EXPECT_THAT(text,
              HasSubstr("the mount moved by +0.420 +- 0.080 deg about the camera's y since "
                        "2023-11-14 22:13:20 UTC (chi-square 27.6 of 6, by chance once in 8"));
}

TEST(ComparisonText, SinceAnEarlierDayOnly) {
  CalibrationComparison comparison = Turned(0.42, 27.6);
  comparison.utime_b = comparison.utime_a - 1;
  EXPECT_THAT(ComparisonText(comparison), Not(HasSubstr("since")));
}

TEST(ComparisonText, NamesEachAxisThatIsClear) {
  CalibrationComparison comparison = Turned(0.42, 80);
  comparison.cameras[0].centre_mm[0].value = -14;
  EXPECT_THAT(
      ComparisonText(comparison),
      HasSubstr("the mount moved by -14.0 +- 2.0 mm along the LIDAR's x, +0.420 +- 0.080 deg "
                "about the camera's y since"));
}

TEST(ComparisonText, WithoutACovarianceItSaysSo) {
  CalibrationComparison comparison = Turned(0.42, 0);
  comparison.same_rig = false;
  comparison.cameras[0].chi2.reset();
  comparison.cameras[0].rotation_deg[1].sigma = std::numeric_limits<double>::quiet_NaN();
  const std::string text = ComparisonText(comparison);
  EXPECT_THAT(text, HasSubstr("0.420 deg and 0.0 mm apart"));
  EXPECT_THAT(text, HasSubstr("cannot be told"));
  EXPECT_THAT(text, HasSubstr("the rig files differ"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_FALSE(Moved(comparison.cameras[0]));
}

}  // namespace
}  // namespace rgbdt
