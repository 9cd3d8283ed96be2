#include "calib/present/layout/frame.h"

#include "tests/unit/present/frames/frame_testing.h"

namespace rgbdt {
namespace {

TEST(Frame, ArraysBeginAtMultiplesOfEightAndComeBack) {
  for (std::size_t odd = 0; odd < 20; ++odd) {
    FrameWriter writer({{"type", "image"}, {"text", std::string(odd, 'x')}});
    writer.AddBytes("first", std::string(odd, '\x81'));
    writer.AddFloats("second", {1.5F, -2, 1e30F});
    writer.AddBytes("third", "abc");
    const std::string bytes = writer.Finish();
    const ParsedFrame frame = Parse(bytes);
    EXPECT_EQ(frame.id, 0U);
    EXPECT_EQ(NumberAt(bytes, 4) % 8, 0U);
    EXPECT_EQ(frame.arrays.at("first"), std::string(odd, '\x81'));
    EXPECT_THAT(frame.Floats("second"), testing::ElementsAre(1.5F, -2, 1e30F));
    EXPECT_EQ(frame.arrays.at("third"), "abc");
  }
}

TEST(Frame, TheLastArrayMayBeWrittenAfterwards) {
  FrameWriter writer(nlohmann::json{{"type", "cloud"}});
  writer.AddBytes("first", "abc");
  std::string bytes = writer.FinishWith("points", 64);
  bytes.replace(bytes.size() - 64, 64, std::string(64, 'p'));
  const ParsedFrame frame = Parse(bytes);
  EXPECT_EQ(frame.arrays.at("first"), "abc");
  EXPECT_EQ(frame.arrays.at("points"), std::string(64, 'p'));
}

TEST(Frame, WithoutArraysItIsItsHeader) {
  const ParsedFrame frame = Parse(JsonFrame({{"type", "notice"}, {"text", "\xff\"</script>"}}));
  EXPECT_EQ(frame.header.at("text"), "\xEF\xBF\xBD\"</script>");
  EXPECT_EQ(frame.header.count("arrays"), 0U);
}

TEST(Frame, WhatIsNotFiniteIsNull) {
  EXPECT_EQ(FiniteOrNull(0.5), nlohmann::json(0.5));
  EXPECT_TRUE(FiniteOrNull(std::nan("")).is_null());
  EXPECT_TRUE(FiniteOrNull(-INFINITY).is_null());
}

TEST(Frame, AMatrixIsRowByRow) {
  Rigid3 pose = RotationAbout({0, 0, 1}, M_PI / 2);  // x to y
  pose.translation = {1, 2, 3};
  const std::vector<double> matrix = MatrixOf(pose);
  const std::vector<double> expected = {0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1};
  EXPECT_THAT(matrix, testing::Pointwise(testing::DoubleNear(1e-12), expected));
}

}  // namespace
}  // namespace rgbdt
