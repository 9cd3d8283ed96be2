#include "calib/model/statistics.h"

#include <gtest/gtest.h>

#include <limits>

#include "calib/model/slice.h"

namespace rgbdt {
namespace {

TEST(Median, IsAlwaysAValueThatIsThere) {
  EXPECT_EQ(Median<double>({7}), 7);
  EXPECT_EQ(Median<double>({3, 1, 2}), 2);
  EXPECT_EQ(Median<double>({4, 1, 3, 2}), 3) << "the upper one of the two in the middle";
  EXPECT_EQ(Median<float>({1, 2, std::numeric_limits<float>::infinity()}), 2);
}

TEST(Median, OfNoneIsWhatTheCallerSays) {
  EXPECT_EQ(Median<double>({}), 0);
  EXPECT_EQ(Median<double>({}, -5), -5);
}

TEST(Nth, CountsFromTheSmallest) {
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(Nth<double>({10, 13, 11, 12}, k), 10 + static_cast<double>(k));
  }
}

TEST(Slice, OfNothingIsNothing) {
  EXPECT_EQ(Slice(std::vector<int>{1, 2, 3, 4}, 1, 3), (std::vector<int>{2, 3}));
  EXPECT_TRUE(Slice(std::vector<int>{}, 1, 3).empty());
}

}  // namespace
}  // namespace rgbdt
