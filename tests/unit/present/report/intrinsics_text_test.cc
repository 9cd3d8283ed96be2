#include "calib/present/report/intrinsics_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rgbdt {
namespace {

LensComparison Compared(LensChoice asked) {
  LensComparison comparison;
  comparison.asked = asked;
  comparison.others = {{LensChoice::kPinhole5, true, 0.3126, 0.3121, -20},
                       {LensChoice::kFisheye, true, 0.09, 0.3126, -900}};
  return comparison;
}

TEST(LensComparisonText, NamesTheModelThatTheImagesWant) {
  LensComparison comparison = Compared(LensChoice::kPinhole8);
  comparison.better = comparison.others[1];
  EXPECT_EQ(LensComparisonText(comparison),
            "  fisheye fits these images better: RMS 0.090 px against 0.313 px; give --model "
            "fisheye\n");
  comparison.better = comparison.others[0];
  EXPECT_EQ(LensComparisonText(comparison),
            "  pinhole5 fits these images as well, with fewer numbers: RMS 0.313 px against 0.312 "
            "px; give --model pinhole5\n");
}

TEST(LensComparisonText, SaysThatNoneFitsBetter) {
  LensComparison comparison = Compared(LensChoice::kPinhole8);
  comparison.others[1].converged = false;
  EXPECT_EQ(LensComparisonText(comparison),
            "  no other lens model fits these images better: pinhole5 RMS 0.313 px, fisheye does "
            "not converge\n");
}

}  // namespace
}  // namespace rgbdt
