#include "calib/files/import/board_text.h"

#include "calib/model/beam_priors.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ErrorOfBoard(const std::string& text) {
  return test::ErrorOf([&] { ParseBoard(text); });
}

TEST(BoardText, CountsSquares) {
  for (const char* text :
       {"8x6@0.095,0.85x0.61", "8x6squares@0.095,0.85x0.61", "7x5corners@0.095,0.85x0.61"}) {
    const Target board = ParseBoard(text);
    EXPECT_EQ(board.squares_x, 8) << text;
    EXPECT_EQ(board.squares_y, 6) << text;
    EXPECT_EQ(board.square_m, 0.095);
    EXPECT_EQ(board.width_m, 0.85);
    EXPECT_EQ(board.height_m, 0.61);
    EXPECT_EQ(board.print_sigma, kUsualPrintSigma);
    EXPECT_EQ(DescribeBoard(board), "8 x 6 squares of 0.095 m (7 x 5 inner corners)");
  }
}

TEST(BoardText, KnowsPlainBoards) {
  const Target board = ParseBoard("plain@1.016x0.9");
  EXPECT_FALSE(board.HasPattern());
  EXPECT_EQ(board.width_m, 1.016);
  EXPECT_EQ(board.height_m, 0.9);
  EXPECT_EQ(DescribeBoard(board), "plain, 1.016 x 0.9 m");
}

TEST(BoardText, KnowsBoardsWithMarkers) {
  const Target charuco = ParseBoard("charuco@8x6,0.095,0.07,DICT_5X5_100,0.85x0.61,legacy");
  ASSERT_TRUE(charuco.markers.has_value());
  EXPECT_EQ(charuco.squares_x, 8);
  EXPECT_EQ(charuco.squares_y, 6);
  EXPECT_EQ(charuco.markers->side_m, 0.07);
  EXPECT_EQ(charuco.markers->family, "5X5_100");
  EXPECT_TRUE(charuco.markers->legacy);
  EXPECT_EQ(DescribeBoard(charuco),
            "ChArUco, 8 x 6 squares of 0.095 m, markers of 0.07 m (5X5_100, legacy)");
  const Target grid = ParseBoard("aprilgrid@6x5,0.1,0.25,36h11,0.85x0.75");
  ASSERT_TRUE(grid.markers.has_value());
  EXPECT_EQ(grid.corners_x(), 12);
  EXPECT_EQ(grid.corners_y(), 10);
  EXPECT_EQ(grid.markers->gap_m, 0.025);
  EXPECT_EQ(DescribeBoard(grid), "6 x 5 APRILTAG_36h11 tags of 0.1 m, 0.025 m apart");
}

TEST(BoardText, KnowsTheBoardOfVelo2camAndFastCalib) {
  const Target board = ParseBoard("velo2cam@0.16");
  ASSERT_TRUE(board.holes.has_value());
  EXPECT_EQ(board.markers->side_m, 0.16);
  EXPECT_EQ(board.width_m, 1.4);
  EXPECT_EQ(DescribeBoard(board),
            "four holes of 0.12 m radius, 6X6_250 markers of 0.16 m, 1.4 x 1 m");
  EXPECT_EQ(ParseBoard("fast-calib@0.2,1.5x1.1").height_m, 1.1);
  EXPECT_THAT(ErrorOfBoard("velo2cam"), HasSubstr("expected \"@\""));
  EXPECT_THAT(ErrorOfBoard("velo2cam@160"), HasSubstr("looks like millimetres"));
  EXPECT_THAT(ErrorOfBoard("velo2cam@0.16,1.2x0.9"), HasSubstr("need 1.26 x 0.86 m"));
}

TEST(BoardText, MarkersThatCannotBeAreRefused) {
  EXPECT_THAT(ErrorOfBoard("charuco@8x6,0.07,0.095,5X5_100,0.85x0.61"),
              HasSubstr("not smaller than its square"));
  EXPECT_THAT(ErrorOfBoard("charuco@8x6,0.095,0.07,5X6_100,0.85x0.61"),
              AllOf(HasSubstr("\"5X6_100\""), HasSubstr("one of 4X4_50, ")));
  EXPECT_THAT(ErrorOfBoard("charuco@12x9,0.05,0.04,4X4_50,0.85x0.61"),
              HasSubstr("the board has 54 markers, but 4X4_50 only 50"));
  EXPECT_THAT(ErrorOfBoard("charuco@8x6,0.095,0.07,0.85x0.61"), HasSubstr("\"0.85x0.61\""));
  EXPECT_THAT(ErrorOfBoard("aprilgrid@6x5,0.1,25,36h11,0.85x0.75"), HasSubstr("over a tag's side"));
  EXPECT_THAT(ErrorOfBoard("aprilgrid@6x5,0.1,0.3,36h11,0.7x0.65"), HasSubstr("more than the"));
}

TEST(BoardText, LengthsThatAreNoMetresAreRefusedWithWhatWasMeant) {
  EXPECT_THAT(ErrorOfBoard("8x6@95,850x610"), AllOf(HasSubstr("millimetres"), HasSubstr("0.095")));
  EXPECT_THAT(ErrorOfBoard("8x6@9.5,0.85x0.61"),
              AllOf(HasSubstr("centimetres"), HasSubstr("metres: 0.095")));
  EXPECT_THAT(ErrorOfBoard("8x6@0.095,850x610"),
              AllOf(HasSubstr("width is 850 m"), HasSubstr("millimetres"), HasSubstr("0.85")));
  EXPECT_THAT(ErrorOfBoard("plain@101.6x101.6"),
              AllOf(HasSubstr("centimetres"), HasSubstr("1.016")));
  EXPECT_THAT(ErrorOfBoard("8x6@0,0.85x0.61"), HasSubstr("more than 0"));
  EXPECT_THAT(ErrorOfBoard("8x6@nan,0.85x0.61"), HasSubstr("more than 0"));
  EXPECT_THAT(ErrorOfBoard("8x6@0.1,infx0.61"),
              AllOf(HasSubstr("width is inf m"), HasSubstr("0.015 to 5")));
  EXPECT_THAT(ErrorOfBoard("8x6@0.1,1x1e-9"),
              AllOf(HasSubstr("height is 1e-09 m"), HasSubstr("expected metres, 0.015 to 5")));
  EXPECT_THAT(ErrorOfBoard("8x6@1e-9,0.85x0.61"), HasSubstr("square's side is 1e-09 m"));
}

TEST(BoardText, APatternLargerThanItsBoardIsExplained) {
  EXPECT_THAT(ErrorOfBoard("8x6corners@0.095,0.85x0.61"),
              AllOf(HasSubstr("9 x 7 squares"), HasSubstr("not of inner corners")));
  EXPECT_THAT(ErrorOfBoard("6x8@0.095,0.85x0.61"), HasSubstr("the other way round"));
}

TEST(BoardText, WhatIsMissingIsNamed) {
  for (const char* text : {"", "8", "8x", "8x6", "8x6@", "8x6@0.095", "8x6@0.095,", "x6@0.1,1x1",
                           "8x6@0.095,0.85", "8x6@0.095,0.85x", "8x6@0.095,0.85x0.61m", "plain",
                           "plain@1", "plain@1x1x1", "8,6@0.095,0.85x0.61"}) {
    EXPECT_THAT(ErrorOfBoard(text), AllOf(HasSubstr("expected"), HasSubstr("--board")));
  }
  EXPECT_THAT(ErrorOfBoard("8x6@0.095"), AllOf(HasSubstr("its end"), HasSubstr("\",\"")));
  EXPECT_THAT(ErrorOfBoard("2x6@0.095,0.85x0.61"), HasSubstr("2 squares in a row"));
  EXPECT_THAT(ErrorOfBoard("2000000000000x6@0.095,0.85x0.61"), HasSubstr("expected"));
  EXPECT_THAT(ErrorOfBoard("2147483647x5corners@0.095,0.85x0.61"), HasSubstr("3 to 100"));
}

}  // namespace
}  // namespace rgbdt
