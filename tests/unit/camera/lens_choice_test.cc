#include "calib/camera/lens_choice.h"

#include <algorithm>

#include "tests/unit/camera/intrinsics_testing.h"
#include "tests/unit/camera/lenses.h"

namespace rgbdt {
namespace {

// Of made corners of that lens, asked for another model.
LensComparison Compare(const CameraSpec& spec, LensChoice asked, std::uint32_t seed,
                       double sigma_px = 0.1) {
  IntrinsicsInput input = InputOf(spec, 10, sigma_px, seed);
  input.choice = asked;
  return CompareLenses(input, CalibrateIntrinsics(input));
}

TEST(LensChoice, AFisheyeIsWantedByAFisheyesImages) {
  for (const std::uint32_t seed : {1U, 2U}) {
    const LensComparison comparison =
        Compare(SpecNamed("acfr_fisheye"), LensChoice::kPinhole5, seed);
    ASSERT_TRUE(comparison.better) << seed;
    EXPECT_EQ(comparison.better->choice, LensChoice::kFisheye) << seed;
    EXPECT_LT(comparison.better->rms_px, 0.95 * comparison.better->asked_rms_px);
    EXPECT_EQ(comparison.others.size(), 2U);
  }
}

TEST(LensChoice, TheRationalModelIsWantedWhereFiveNumbersDoNotDo) {
  for (const std::uint32_t seed : {1U, 2U}) {
    const LensComparison comparison =
        Compare(SpecNamed("eight_coefficients"), LensChoice::kPinhole5, seed);
    ASSERT_TRUE(comparison.better) << seed;
    EXPECT_EQ(comparison.better->choice, LensChoice::kPinhole8) << seed;
  }
}

// The right model was asked for: chance makes none better, whatever its numbers.
TEST(LensChoice, TheRightModelStays) {
  for (const NamedLens& lens : Lenses()) {
    for (const std::uint32_t seed : {1U, 2U}) {
      const LensChoice right = ChoiceOf(lens.spec.lens);
      const LensComparison comparison = Compare(lens.spec, right, seed);
      EXPECT_FALSE(comparison.better) << lens.name << ", seed " << seed;
      EXPECT_EQ(comparison.asked, right);
    }
  }
}

TEST(LensChoice, NumbersThatExplainNothingAreNotWanted) {
  for (const std::uint32_t seed : {1U, 2U}) {
    const LensComparison comparison =
        Compare(SpecNamed("five_coefficients"), LensChoice::kPinhole8, seed);
    ASSERT_TRUE(comparison.better) << seed;
    EXPECT_EQ(comparison.better->choice, LensChoice::kPinhole5);
    EXPECT_LT(comparison.better->bic, 0);
  }
}

TEST(LensChoice, PerfectCornersWantNothingElse) {
  const LensComparison comparison =
      Compare(SpecNamed("five_coefficients"), LensChoice::kPinhole5, 1, 0);
  EXPECT_FALSE(comparison.better);
}

TEST(LensChoice, ViewsThatDetermineNothingSayNothing) {
  IntrinsicsInput input = InputOf(SpecNamed("five_coefficients"), 2, 0.1, 1);
  const LensComparison comparison = CompareLenses(input, CalibrateIntrinsics(input));
  EXPECT_FALSE(comparison.better);
}

}  // namespace
}  // namespace rgbdt
