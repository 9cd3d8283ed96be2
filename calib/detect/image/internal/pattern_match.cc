#include "calib/detect/image/internal/pattern_match.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kSeen = 0.6;       // of the pattern's corners, at least
constexpr double kTolerance = 0.2;  // of a corner, of the distance to the next
constexpr int kBeyond = 2;          // corners beyond the outermost saddle that may be the pattern's
constexpr int kMargin = kBeyond + 1;
constexpr std::size_t kLeastSteps = 3;  // beyond an end, to tell that the pattern goes on there

bool AnyMissing(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
}

// Near the image's edge by what is seen of it.
bool GoesOnBeyond(const std::vector<double>& along, const std::vector<double>& across,
                  double typical) {
  const auto seen_along = SeenSteps(along, typical);
  const auto seen_across = SeenSteps(across, typical);
  return seen_along.size() >= kLeastSteps && seen_across.size() >= kLeastSteps &&
         GoesOn(seen_along, seen_across);
}

struct Rated {
  PatternFit fit = PatternFit::kNo;
  double weakest = 0;  ///< alternation of the weakest row or column, of the median
};

// Whether the squares from (column, row) on, so many columns and rows, alternate; and whether they
// go on beyond.
Rated Rate(const SquareSteps& edges, int column, int row, int columns, int rows) {
  std::vector<std::vector<double>> inside;
  inside.reserve(static_cast<std::size_t>(rows + columns));
  for (int r = 0; r < rows; ++r) {
    inside.push_back(edges.Along(column, row + r, false, columns));
  }
  for (int c = 0; c < columns; ++c) {
    inside.push_back(edges.Along(column + c, row, true, rows));
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
  const bool goes_on = GoesOnBeyond(edges.Along(column, row - 1, false, columns),
                                    edges.Across(column, row - 1, true, columns), typical) ||
                       GoesOnBeyond(edges.Along(column, row + rows, false, columns),
                                    edges.Across(column, row + rows - 1, true, columns), typical) ||
                       GoesOnBeyond(edges.Along(column - 1, row, true, rows),
                                    edges.Across(column - 1, row, false, rows), typical) ||
                       GoesOnBeyond(edges.Along(column + columns, row, true, rows),
                                    edges.Across(column + columns - 1, row, false, rows), typical);
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

std::vector<PatternMatch> PlacesIn(const Range& columns, const Range& rows, int reach,
                                   const Target& target) {
  std::vector<PatternMatch> places;
  for (const bool turned : {false, true}) {
    PatternMatch match;
    match.turned = turned;
    const int wide = match.columns(target);
    const int high = match.rows(target);
    if (turned && wide == high) continue;
    for (match.row = rows.low - reach; match.row + high - 1 <= rows.high + reach; ++match.row) {
      for (match.column = columns.low - reach; match.column + wide - 1 <= columns.high + reach;
           ++match.column) {
        places.push_back(match);
      }
    }
  }
  return places;
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
  const SquareSteps edges(grey, model, columns, rows, kMargin);
  const double enough = kSeen * target.corners_x() * target.corners_y();
  std::vector<std::pair<double, PatternMatch>> rated;
  for (const PatternMatch& match : PlacesIn(columns, rows, kBeyond, target)) {
    const auto seen = static_cast<double>(CornersIn(match, agreeing, target).size());
    if (seen < enough) continue;
    // The squares between the corners, without the outermost ones.
    const double weakest =
        Rate(edges, match.column, match.row, match.columns(target) - 1, match.rows(target) - 1)
            .weakest;
    if (weakest > 0) rated.emplace_back(weakest * seen, match);
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
  const SquareSteps edges(grey, model, {match.column - 1, match.column + wide},
                          {match.row - 1, match.row + high}, kMargin);
  return Rate(edges, match.column - 1, match.row - 1, wide + 1, high + 1).fit;
}

}  // namespace rgbdt
