#include "calib/fuse/range_correction.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

RangeErrors Off(double offset_m) {
  RangeErrors errors;
  errors.offset_m.value = offset_m;
  return errors;
}

TEST(RangeCorrectionFor, CamerasSolvedTogetherHaveTheSame) {
  const RangeCorrection correction = RangeCorrectionFor({Off(0.02), Off(0.02), Off(0.02)});
  ASSERT_TRUE(correction.errors);
  EXPECT_EQ(correction.errors->offset_m.value, 0.02);
  EXPECT_FALSE(correction.cameras_differ);
}

TEST(RangeCorrectionFor, OfCamerasThatDifferTheFirstHolds) {
  const RangeCorrection correction = RangeCorrectionFor({Off(0.02), Off(0.02), Off(0.03)});
  ASSERT_TRUE(correction.errors);
  EXPECT_EQ(correction.errors->offset_m.value, 0.02);
  EXPECT_TRUE(correction.cameras_differ);
}

TEST(RangeCorrectionFor, ACameraWithoutDiffersFromOneThatHasThem) {
  const RangeCorrection first_without = RangeCorrectionFor({std::nullopt, Off(0.02), Off(0.03)});
  ASSERT_TRUE(first_without.errors);
  EXPECT_EQ(first_without.errors->offset_m.value, 0.02) << "the first that has any";
  EXPECT_TRUE(first_without.cameras_differ);
  const RangeCorrection last_without = RangeCorrectionFor({Off(0.02), std::nullopt});
  ASSERT_TRUE(last_without.errors);
  EXPECT_TRUE(last_without.cameras_differ);
}

TEST(RangeCorrectionFor, NothingWhereNoCameraHasAny) {
  for (const RangeCorrection& correction :
       {RangeCorrectionFor({}), RangeCorrectionFor({std::nullopt, std::nullopt})}) {
    EXPECT_FALSE(correction.errors);
    EXPECT_FALSE(correction.cameras_differ);
  }
}

}  // namespace
}  // namespace rgbdt
