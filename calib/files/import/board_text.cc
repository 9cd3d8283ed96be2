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
  // Up to the next comma.
  std::string Word(const char* what) {
    std::string word = text_.substr(at_, text_.find(',', at_) - at_);
    if (word.empty()) Fail(std::string("expected ") + what);
    at_ += word.size();
    return word;
  }
  void RequireEnd() {
    if (at_ < text_.size()) Fail("expected nothing more");
  }
  [[noreturn]] void Fail(const std::string& expected) const {
    const std::string rest = at_ < text_.size() ? "\"" + text_.substr(at_) + "\"" : "its end";
    throw InputError("--board " + text_ + ": at " + rest + " " + expected +
                     "; it is SQUARESxSQUARES@SQUARE,WIDTHxHEIGHT in metres, such as "
                     "8x6@0.095,0.85x0.61, or plain@WIDTHxHEIGHT, or "
                     "charuco@SQUARESxSQUARES,SQUARE,MARKER,DICTIONARY,WIDTHxHEIGHT, or "
                     "aprilgrid@TAGSxTAGS,TAG,SPACING,FAMILY,WIDTHxHEIGHT, or the board with "
                     "four holes velo2cam@MARKER (or fast-calib@MARKER)");
  }

 private:
  const std::string& text_;
  std::size_t at_ = 0;
};

// `least`: what is shorter in metres once millimetres are converted must have been centimetres. No
// board is ten times smaller still.
void CheckMetres(const std::string& text, double value, const char* what, double least,
                 double most) {
  const std::string is = "--board " + text + ": " + what + " is " + Exact(value) + " m";
  if (!(value > 0)) throw InputError(is + "; expected more than 0");
  if (std::isinf(value) || value < least / 10) {
    throw InputError(is + Format("; expected metres, %g to %g", least / 10, most));
  }
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
  const double width = board.PatternSize().x();
  const double height = board.PatternSize().y();
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

void CheckCount(const std::string& text, int count, const char* of, int least, int most) {
  if (count >= least && count <= most) return;
  throw InputError("--board " + text + ": " + std::to_string(count) + " " + of +
                   Format(" in a row; expected %d to %d", least, most));
}

// A family of markers that has enough of them for the board.
void ReadFamily(const std::string& text, const std::string& prefix, const char* what,
                Reader* reader, Target* board) {
  const std::string name = reader->Word(what);
  const MarkerFamily* family = FindMarkerFamily(prefix + name);
  if (family == nullptr) {
    throw InputError("--board " + text + ": no markers are called \"" + name +
                     "\"; expected one of " + MarkerFamilyNames());
  }
  board->markers->family = family->name;
  const auto count = board->MarkerPlaces().size();
  if (count <= static_cast<std::size_t>(family->count)) return;
  throw InputError(
      "--board " + text +
      Format(": the board has %zu markers, but %s only %d", count, family->name, family->count));
}

// What every board with a pattern ends with.
void ReadEnd(const std::string& text, Reader* reader, Target* board) {
  reader->Require(",");
  ReadSize(text, reader, board);
  board->print_sigma = kUsualPrintSigma;
}

Target ParseCharuco(const std::string& text, Reader* reader) {
  Target board;
  reader->Require("@");
  board.squares_x = reader->Number<int>("a number of squares");
  reader->Require("x");
  board.squares_y = reader->Number<int>("a number of squares");
  CheckCount(text, board.squares_x, "squares", 3, 100);
  CheckCount(text, board.squares_y, "squares", 3, 100);
  reader->Require(",");
  board.square_m = reader->Number<double>("a square's side in metres");
  CheckMetres(text, board.square_m, "a square's side", 0.01, kMostSquareM);
  reader->Require(",");
  board.markers = Markers{};
  board.markers->side_m = reader->Number<double>("a marker's side in metres");
  CheckMetres(text, board.markers->side_m, "a marker's side", 0.005, kMostSquareM);
  if (board.markers->side_m >= board.square_m) {
    throw InputError("--board " + text + ": a marker of " + Exact(board.markers->side_m) +
                     " m is not smaller than its square of " + Exact(board.square_m) +
                     " m; the square comes first");
  }
  reader->Require(",");
  ReadFamily(text, "", "the markers' dictionary, such as 5X5_100", reader, &board);
  ReadEnd(text, reader, &board);
  board.markers->legacy = reader->Take(",legacy");
  reader->RequireEnd();
  CheckFits(text, board);
  return board;
}

Target ParseAprilGrid(const std::string& text, Reader* reader) {
  Markers markers;
  reader->Require("@");
  const int tags_x = reader->Number<int>("a number of tags");
  reader->Require("x");
  const int tags_y = reader->Number<int>("a number of tags");
  CheckCount(text, tags_x, "tags", 2, 49);
  CheckCount(text, tags_y, "tags", 2, 49);
  reader->Require(",");
  markers.side_m = reader->Number<double>("a tag's side in metres");
  CheckMetres(text, markers.side_m, "a tag's side", 0.01, kMostSquareM);
  reader->Require(",");
  const auto spacing = reader->Number<double>("the gap between tags, over a tag's side");
  if (!(spacing > 0 && spacing < 2)) {
    throw InputError("--board " + text + ": the spacing is " + Exact(spacing) +
                     "; expected the gap between tags over a tag's side, as Kalibr's: 0.3 or so");
  }
  markers.gap_m = spacing * markers.side_m;
  markers.border_bits = kKalibrBorderBits;
  Target board = GridOfMarkers(tags_x, tags_y, markers);
  reader->Require(",");
  ReadFamily(text, "APRILTAG_", "the tags' family, such as 36h11", reader, &board);
  ReadEnd(text, reader, &board);
  reader->RequireEnd();
  CheckFits(text, board);
  return board;
}

// velo2cam@MARKER[,WIDTHxHEIGHT]: holes and markers lie where that board's drawing has them.
Target ParseBoardWithHoles(const std::string& text, Reader* reader) {
  Markers markers;
  markers.family = kHolesFamily;
  reader->Require("@");
  markers.side_m = reader->Number<double>("a marker's side (its black square) in metres");
  CheckMetres(text, markers.side_m, "a marker's side", 0.05, 0.3);
  Target board = BoardWithHoles(markers);
  if (reader->Take(",")) ReadSize(text, reader, &board);
  reader->RequireEnd();
  board.print_sigma = kUsualPrintSigma;
  const Eigen::Vector2d size = board.PatternSize();
  constexpr double kRimM = 0.01;
  if (size.x() + 2 * kRimM > board.width_m || size.y() + 2 * kRimM > board.height_m) {
    throw InputError("--board " + text + ": markers of " + Exact(markers.side_m) +
                     Format(" m where that board has them need %g x %g m and a rim of 1 cm",
                            size.x(), size.y()) +
                     Format("; the board has %g x %g m", board.width_m, board.height_m));
  }
  return board;
}

}  // namespace

Target ParseBoard(const std::string& text) {
  Reader reader(text);
  if (reader.Take("velo2cam") || reader.Take("fast-calib")) {
    return ParseBoardWithHoles(text, &reader);
  }
  if (reader.Take("charuco")) return ParseCharuco(text, &reader);
  if (reader.Take("aprilgrid")) return ParseAprilGrid(text, &reader);
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
  CheckCount(text, board.squares_x, "squares", 3, 100);
  CheckCount(text, board.squares_y, "squares", 3, 100);
  reader.Require("@");
  board.square_m = reader.Number<double>("a square's side in metres");
  CheckMetres(text, board.square_m, "a square's side", 0.01, kMostSquareM);
  ReadEnd(text, &reader, &board);
  reader.RequireEnd();
  CheckFits(text, board);
  return board;
}

std::string DescribeBoard(const Target& board) {
  if (!board.HasPattern()) return Format("plain, %g x %g m", board.width_m, board.height_m);
  if (board.holes) {
    return Format("four holes of %g m radius, %s markers of %g m, %g x %g m", board.holes->radius_m,
                  board.markers->family.c_str(), board.markers->side_m, board.width_m,
                  board.height_m);
  }
  if (board.markers && board.markers->grid()) {
    return Format("%d x %d %s tags of %g m, %g m apart", board.squares_x / 2, board.squares_y / 2,
                  board.markers->family.c_str(), board.markers->side_m, board.markers->gap_m);
  }
  if (board.markers) {
    return Format("ChArUco, %d x %d squares of %g m, markers of %g m (%s%s)", board.squares_x,
                  board.squares_y, board.square_m, board.markers->side_m,
                  board.markers->family.c_str(), board.markers->legacy ? ", legacy" : "");
  }
  return Format("%d x %d squares of %g m (%d x %d inner corners)", board.squares_x, board.squares_y,
                board.square_m, board.corners_x(), board.corners_y());
}

}  // namespace rgbdt
