#include "calib/model/unique_names.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

TEST(UniqueNames, WhatIsTakenGetsANumber) {
  UniqueNames names;
  EXPECT_TRUE(names.Insert("rgb_3"));
  EXPECT_FALSE(names.Insert("rgb_3"));
  EXPECT_EQ(names.Make("rgb"), "rgb");
  EXPECT_EQ(names.Make("rgb"), "rgb_2");
  EXPECT_EQ(names.Make("rgb"), "rgb_4");  // 3 was there
  EXPECT_EQ(names.Make("rgb_2"), "rgb_2_2");
  EXPECT_FALSE(names.Insert("rgb_4"));
}

// What is made in order is never looked for from its start again: seconds, where it was hours.
TEST(UniqueNames, AMillionAlike) {
  UniqueNames names;
  const std::string wanted(90, 'a');
  for (int i = 0; i < 1000000; ++i) names.Make(wanted);
  EXPECT_EQ(names.Make(wanted), wanted + "_1000001");
}

}  // namespace
}  // namespace rgbdt
