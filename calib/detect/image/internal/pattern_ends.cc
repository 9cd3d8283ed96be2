#include "calib/detect/image/internal/pattern_ends.h"

#include <array>
#include <cmath>
#include <limits>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

constexpr int kLeastSteps = 3;  // between two outermost squares, for an end to be seen

// What the steps between neighbouring squares along one of the pattern's ends say.
struct End {
  int seen = 0;       // next to a corner that was seen
  int alternate = 0;  // of these: from light to dark or back, as they should
  int go_on = 0;      // of the latter: so do the two squares beyond, which are no part of it

  bool ends() const { return alternate >= kLeastSteps && 3 * go_on <= alternate; }
  bool goes_on() const { return alternate >= kLeastSteps && 3 * go_on > 2 * alternate; }
  bool is_not_there() const { return seen >= kLeastSteps && 2 * alternate < seen; }
};

class Steps {
 public:
  Steps(const cv::Mat& grey, const BoardMap& map, const Target& target, double contrast)
      : grey_(grey), map_(map), target_(target), contrast_(contrast) {}

  // From the square (column, row) to the next along the row or, `down`, the column, of what two
  // squares of the pattern differ by; 1 where they alternate. NaN: not seen.
  double At(int column, int row, bool down) const {
    const auto mean = [&](double off) {
      double sum = 0;
      for (const double along : {0.25, 0.35, 0.45, 0.55, 0.65, 0.75}) {
        sum += down ? Value(column + along, row + 1 + off) : Value(column + 1 + off, row + along);
      }
      return sum / 6;
    };
    const double step = 0.5 * (mean(0.15) + mean(0.3) - mean(-0.15) - mean(-0.3));
    return ((column + row) % 2 == 0 ? -step : step) / (2 * contrast_);
  }

 private:
  // Columns and rows count from the pattern's top left, in squares.
  double Value(double column, double row) const {
    const Eigen::Vector2d squares(target_.squares_x, target_.squares_y);
    const auto pixel = map_(target_.pattern_offset_m +
                            target_.square_m * (Eigen::Vector2d(column, row) - 0.5 * squares));
    return pixel ? static_cast<double>(Interpolate(grey_, pixel->x(), pixel->y()))
                 : std::numeric_limits<double>::quiet_NaN();
  }

  const cv::Mat& grey_;
  const BoardMap& map_;
  const Target& target_;
  double contrast_;
};

bool Alternates(double step) { return step > 0.35 && step < 3; }

// `along_row`: the top end (`last` false) or the bottom one; otherwise the left or the right one.
End LookAt(const Steps& steps, const Target& target, const std::vector<Eigen::Vector2d>& corners,
           bool along_row, bool last) {
  End end;
  const int length = along_row ? target.corners_x() : target.corners_y();
  const int across = along_row ? target.corners_y() : target.corners_x();
  const int corner_line = last ? across - 1 : 0;
  const int square_line = last ? across : 0;
  const int beyond_line = last ? across + 1 : -1;
  for (int k = 0; k < length; ++k) {
    const int corner =
        along_row ? corner_line * target.corners_x() + k : k * target.corners_x() + corner_line;
    const auto step = [&](int line) {
      return along_row ? steps.At(k, line, false) : steps.At(line, k, true);
    };
    if (!IsSeen(corners[static_cast<std::size_t>(corner)])) continue;
    ++end.seen;
    if (!Alternates(step(square_line))) continue;
    ++end.alternate;
    end.go_on += Alternates(step(beyond_line)) ? 1 : 0;
  }
  return end;
}

}  // namespace

std::string WhyPatternMayBeShifted(const cv::Mat& grey, const BoardMap& map, const Target& target,
                                   const std::vector<Eigen::Vector2d>& corners, double contrast) {
  const Steps steps(grey, map, target, contrast);
  for (const bool along_row : {true, false}) {
    const std::array<End, 2> ends{LookAt(steps, target, corners, along_row, false),
                                  LookAt(steps, target, corners, along_row, true)};
    const std::string way = along_row ? "top nor bottom" : "left nor right";
    for (const End& end : ends) {
      if (end.goes_on()) return "the checkerboard goes on beyond the picked corners";
      if (end.is_not_there()) return "the checkerboard ends before the picked corners";
    }
    if (!ends[0].ends() && !ends[1].ends()) {
      return "neither " + way + " of the checkerboard's outermost squares can be made out";
    }
  }
  return "";
}

}  // namespace rgbdt
