#include "calib/files/import/board_text.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "calib/model/beam_priors.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kMostSquareM = 0.5, kMostBoardM = 5;

// Takes pieces off the front of what the user gave.
class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  bool Take(const std::string& piece) {
    if (text_.compare(at_, piece.size(), piece) != 0) return false;
    at_ += piece.size();
    return true;
  }
  void Require(const std::string& piece) {
    if (!Take(piece)) Fail("expected \"" + piece + "\"");
  }
  template <typename T>
  T Number(const char* what) {
    T value{};
    const auto end = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (end.ec != std::errc()) Fail(std::string("expected ") + what);
    at_ = static_cast<std::size_t>(end.ptr - text_.data());
    return value;
  }
  void RequireEnd() {
    if (at_ < text_.size()) Fail("expected nothing more");
  }
  [[noreturn]] void Fail(const std::string& expected) const {
    const std::string rest = at_ < text_.size() ? "\"" + text_.substr(at_) + "\"" : "its end";
    throw InputError("--board " + text_ + ": at " + rest + " " + expected +
                     "; it is SQUARESxSQUARES@SQUARE,WIDTHxHEIGHT in metres, such as "
                     "8x6@0.095,0.85x0.61, or plain@WIDTHxHEIGHT");
  }

 private:
  const std::string& text_;
  std::size_t at_ = 0;
};

// `least`: what is shorter in metres once millimetres are converted must have been centimetres.
void CheckMetres(const std::string& text, double value, const char* what, double least,
                 double most) {
  const std::string is = "--board " + text + ": " + what + " is " + Exact(value) + " m";
  if (!(value > 0)) throw InputError(is + "; expected more than 0");
  if (value <= most) return;
  const bool millimetres = value / 1000 >= least;
  throw InputError(is + ", which looks like " + (millimetres ? "millimetres" : "centimetres") +
                   "; expected metres: " + Exact(value / (millimetres ? 1000 : 100)));
}

void ReadSize(const std::string& text, Reader* reader, Target* board) {
  board->width_m = reader->Number<double>("the board's width in metres");
  reader->Require("x");
  board->height_m = reader->Number<double>("the board's height in metres");
  CheckMetres(text, board->width_m, "the board's width", 0.15, kMostBoardM);
  CheckMetres(text, board->height_m, "the board's height", 0.15, kMostBoardM);
}

void CheckFits(const std::string& text, const Target& board) {
  const double width = board.squares_x * board.square_m;
  const double height = board.squares_y * board.square_m;
  const auto fits = [&](double across, double up) {
    return across <= board.width_m + 1e-6 && up <= board.height_m + 1e-6;
  };
  if (fits(width, height)) return;
  const std::string what = "--board " + text + ": " + DescribeBoard(board) + " are " +
                           Format("%g x %g m", width, height) + ", more than the board's " +
                           Format("%g x %g m", board.width_m, board.height_m);
  if (fits(height, width)) {
    throw InputError(what +
                     "; the first count is along the width: are the two the other way round?");
  }
  throw InputError(what +
                   "; counts are of squares, not of inner corners, and the size is of the whole "
                   "board, border included");
}

}  // namespace

Target ParseBoard(const std::string& text) {
  Reader reader(text);
  Target board;
  if (reader.Take("plain")) {
    reader.Require("@");
    ReadSize(text, &reader, &board);
    reader.RequireEnd();
    return board;
  }
  board.squares_x = reader.Number<int>("a number of squares, or plain");
  reader.Require("x");
  board.squares_y = reader.Number<int>("a number of squares");
  if (reader.Take("corners")) {
    // The largest int is refused below, and is not to overflow before.
    for (int* squares : {&board.squares_x, &board.squares_y}) {
      if (*squares < std::numeric_limits<int>::max()) ++*squares;
    }
  } else {
    reader.Take("squares");
  }
  for (const int squares : {board.squares_x, board.squares_y}) {
    if (squares < 3 || squares > 100) {
      throw InputError("--board " + text + ": " + std::to_string(squares) +
                       " squares in a row; expected 3 to 100");
    }
  }
  reader.Require("@");
  board.square_m = reader.Number<double>("a square's side in metres");
  CheckMetres(text, board.square_m, "a square's side", 0.01, kMostSquareM);
  reader.Require(",");
  ReadSize(text, &reader, &board);
  reader.RequireEnd();
  board.print_sigma = kUsualPrintSigma;
  CheckFits(text, board);
  return board;
}

std::string DescribeBoard(const Target& board) {
  if (!board.HasPattern()) return Format("plain, %g x %g m", board.width_m, board.height_m);
  return Format("%d x %d squares of %g m (%d x %d inner corners)", board.squares_x, board.squares_y,
                board.square_m, board.corners_x(), board.corners_y());
}

}  // namespace rgbdt
