#include "calib/detect/image/internal/pattern_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kSeen = 0.6;       // of the pattern's corners, at least
constexpr double kTolerance = 0.2;  // of a corner, of the distance to the next
constexpr int kBeyond = 2;          // corners beyond the outermost saddle that may be the pattern's

struct Range {
  int low = std::numeric_limits<int>::max();
  int high = std::numeric_limits<int>::min();

  void Add(int value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// How much lighter a square of even column + row is than the next, at the edge between them. The
// step itself counts and not what is farther away: samples on either side, their slope taken off.
class Edges {
 public:
  /// `columns`, `rows`: of the outermost corners.
  Edges(const cv::Mat& grey, const GridModel& model, Range columns, Range rows)
      : left_(columns.low - kMargin), top_(rows.low - kMargin) {
    const cv::Size size(columns.high - columns.low + 2 * kMargin,
                        rows.high - rows.low + 2 * kMargin);
    for (const bool down : {false, true}) {
      cv::Mat& steps = down ? down_ : across_;
      steps = cv::Mat(size, CV_64F);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          steps.at<double>(y, x) = Step(grey, model, left_ + x, top_ + y, down);
        }
      }
    }
  }

  /// Between the square of that column and row and the one to the right of it or, `down`, below.
  /// NaN: not seen.
  double At(int column, int row, bool down) const {
    const int x = column - left_;
    const int y = row - top_;
    const bool inside = x >= 0 && y >= 0 && x < across_.cols && y < across_.rows;
    return inside ? (down ? down_ : across_).at<double>(y, x)
                  : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static constexpr int kMargin = kBeyond + 1;

  static double Step(const cv::Mat& grey, const GridModel& model, int column, int row, bool down) {
    const auto mean = [&](double off) {
      double sum = 0;
      for (const double along : {0.25, 0.35, 0.45, 0.55, 0.65, 0.75}) {
        const Eigen::Vector2d place =
            model.At(column + (down ? along : 1 + off), row + (down ? 1 + off : along));
        sum += Interpolate(grey, place.x(), place.y());
      }
      return sum / 6;
    };
    const double slope = mean(0.35) - mean(0.15) + mean(-0.15) - mean(-0.35);
    const double step = mean(0.15) - mean(-0.15) - 0.75 * slope;
    return (column + row) % 2 == 0 ? -step : step;
  }

  int left_, top_;
  cv::Mat across_, down_;
};

// Along a row or column of squares.
std::vector<double> Alternation(const Edges& edges, int column, int row, bool down, int squares) {
  std::vector<double> steps;
  for (int k = 0; k + 1 < squares; ++k) {
    steps.push_back(edges.At(column + (down ? 0 : k), row + (down ? k : 0), down));
  }
  return steps;
}

// From the squares of a row (`down`) or column to the next below or to the right.
std::vector<double> Across(const Edges& edges, int column, int row, bool down, int squares) {
  std::vector<double> steps;
  for (int k = 0; k < squares; ++k) {
    steps.push_back(edges.At(column + (down ? k : 0), row + (down ? 0 : k), down));
  }
  return steps;
}

double ShareBetween(const std::vector<double>& values, double low, double high) {
  const auto inside =
      std::count_if(values.begin(), values.end(), [&](double v) { return v >= low && v <= high; });
  return static_cast<double>(inside) / static_cast<double>(values.size());
}

bool AnyMissing(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
}

// Steps of a row or column, of what is typical. A hand may cover some squares; light may fall off
// along the board.
bool Alternates(const std::vector<double>& steps) {
  return Median(steps) > 0.3 && ShareBetween(steps, 0.15, 5) > 0.6;
}

// Whether steps along the row or column beyond an end, and those across to it, are a
// checkerboard's. Stricter than within: what lies beside a board may happen to go up and down, as a
// roller door does, but half of the outermost squares look like the border beyond them.
bool GoesOn(std::vector<double> along, std::vector<double> across, double typical) {
  if (AnyMissing(along) || AnyMissing(across)) return false;
  for (double& v : along) v /= typical;
  for (double& v : across) v /= typical;
  return Median(along) > 0.4 && ShareBetween(along, 0.3, 3) > 0.7 &&
         ShareBetween(across, 0.3, 3) > 0.7;
}

struct Rated {
  PatternFit fit = PatternFit::kNo;
  double weakest = 0;  ///< alternation of the weakest row or column, of the median
};

// Whether the squares from (column, row) on, so many columns and rows, alternate; and whether they
// go on beyond.
Rated Rate(const Edges& edges, int column, int row, int columns, int rows) {
  std::vector<std::vector<double>> inside;
  inside.reserve(static_cast<std::size_t>(rows + columns));
  for (int r = 0; r < rows; ++r) {
    inside.push_back(Alternation(edges, column, row + r, false, columns));
  }
  for (int c = 0; c < columns; ++c) {
    inside.push_back(Alternation(edges, column + c, row, true, rows));
  }
  std::vector<double> strengths;
  for (const auto& line : inside) {
    if (AnyMissing(line)) return {};
    strengths.push_back(Median(line));
  }
  const double typical = Median(strengths);
  if (typical == 0) return {};
  Rated rated;
  rated.weakest = 1;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const double relative = strengths[i] / typical;
    for (double& v : inside[i]) v /= typical;
    if (!Alternates(inside[i])) return {};
    rated.weakest = std::min(rated.weakest, relative);
  }
  rated.fit = PatternFit::kYes;
  const bool goes_on = GoesOn(Alternation(edges, column, row - 1, false, columns),
                              Across(edges, column, row - 1, true, columns), typical) ||
                       GoesOn(Alternation(edges, column, row + rows, false, columns),
                              Across(edges, column, row + rows - 1, true, columns), typical) ||
                       GoesOn(Alternation(edges, column - 1, row, true, rows),
                              Across(edges, column - 1, row, false, rows), typical) ||
                       GoesOn(Alternation(edges, column + columns, row, true, rows),
                              Across(edges, column + columns - 1, row, false, rows), typical);
  if (goes_on) rated.fit = PatternFit::kGoesOn;
  return rated;
}

}  // namespace

CornerGrid CornersIn(const PatternMatch& match, const CornerGrid& grid, const Target& target) {
  CornerGrid inside;
  for (const auto& corner : grid) {
    const int c = corner.first.first - match.column;
    const int r = corner.first.second - match.row;
    if (c >= 0 && r >= 0 && c < match.columns(target) && r < match.rows(target)) {
      inside.insert(corner);
    }
  }
  return inside;
}

std::vector<PatternMatch> PatternCandidates(const cv::Mat& grey, const GridModel& model,
                                            const CornerGrid& grid, const Target& target) {
  Range columns;
  Range rows;
  CornerGrid agreeing;
  for (const auto& corner : grid) {
    if (!model.Agrees(corner, kTolerance)) continue;
    agreeing.insert(corner);
    columns.Add(corner.first.first);
    rows.Add(corner.first.second);
  }
  if (agreeing.empty()) return {};
  const Edges edges(grey, model, columns, rows);
  const double enough = kSeen * target.corners_x() * target.corners_y();
  std::vector<std::pair<double, PatternMatch>> rated;
  for (const bool turned : {false, true}) {
    PatternMatch match;
    match.turned = turned;
    const int wide = match.columns(target);
    const int high = match.rows(target);
    if (turned && wide == high) continue;
    for (match.row = rows.low - kBeyond; match.row + high - 1 <= rows.high + kBeyond; ++match.row) {
      for (match.column = columns.low - kBeyond; match.column + wide - 1 <= columns.high + kBeyond;
           ++match.column) {
        const auto seen = static_cast<double>(CornersIn(match, agreeing, target).size());
        if (seen < enough) continue;
        // The squares between the corners, without the outermost ones.
        const double weakest = Rate(edges, match.column, match.row, wide - 1, high - 1).weakest;
        if (weakest > 0) rated.emplace_back(weakest * seen, match);
      }
    }
  }
  std::stable_sort(rated.begin(), rated.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<PatternMatch> candidates;
  candidates.reserve(rated.size());
  for (const auto& [rating, match] : rated) candidates.push_back(match);
  return candidates;
}

PatternFit MatchPattern(const cv::Mat& grey, const GridModel& model, const PatternMatch& match,
                        const Target& target) {
  const int wide = match.columns(target);
  const int high = match.rows(target);
  const Edges edges(grey, model, {match.column - 1, match.column + wide},
                    {match.row - 1, match.row + high});
  return Rate(edges, match.column - 1, match.row - 1, wide + 1, high + 1).fit;
}

}  // namespace rgbdt
