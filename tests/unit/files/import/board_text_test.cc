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
  EXPECT_THAT(ErrorOfBoard("8x6@0.1,infx0.61"), HasSubstr("width is inf m"));
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
