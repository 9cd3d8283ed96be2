#include "calib/detect/image/internal/partial_match.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/detect/image/internal/corner_fit.h"
#include "calib/detect/image/internal/square_steps.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kLeastInside = 0.75;  // of the pattern's corners
constexpr double kLeastInGrid = 0.65;  // likewise: saddles are not found close to the image's edge
constexpr int kLeastSteps = 3;         // of a row or column, for it to say anything
constexpr int kMargin = 2;             // squares beyond the outermost ones that are looked at
constexpr int kReach = 3;              // columns or rows beyond the grid that may be the pattern's

bool SeenEnough(const std::vector<double>& seen, const std::vector<double>& of_all) {
  return seen.size() >= std::max<std::size_t>(kLeastSteps, (of_all.size() + 1) / 2);
}

enum class End {
  kSeen,      // and it ends there
  kCut,       // outside the image
  kGoesOn,    // the pattern is larger
  kDoubtful,  // what lies beyond looks neither like the pattern nor like anything else
};

// Squares: those of the pattern, the outermost ones included.
struct Squares {
  int column, row, columns, rows;
};

// The lines of squares along one of the four ends: the pattern's outermost and the one beyond.
struct Lines {
  int outermost_column, outermost_row, beyond_column, beyond_row;
  int across_column, across_row;  // whose steps lead from the one to the other
  bool down;                      // along a column
  int squares;
};

std::array<Lines, 4> EndsOf(const Squares& s) {
  const int right = s.column + s.columns - 1;
  const int bottom = s.row + s.rows - 1;
  return {{{s.column, s.row, s.column - 1, s.row, s.column - 1, s.row, true, s.rows},
           {right, s.row, right + 1, s.row, right, s.row, true, s.rows},
           {s.column, s.row, s.column, s.row - 1, s.column, s.row - 1, false, s.columns},
           {s.column, bottom, s.column, bottom + 1, s.column, bottom, false, s.columns}}};
}

End Judge(const SquareSteps& steps, const Lines& l, double typical) {
  const auto outermost = steps.Along(l.outermost_column, l.outermost_row, l.down, l.squares);
  const auto beyond = steps.Along(l.beyond_column, l.beyond_row, l.down, l.squares);
  const auto across = steps.Across(l.across_column, l.across_row, !l.down, l.squares);
  const auto seen_outermost = SeenSteps(outermost, typical);
  const auto seen_beyond = SeenSteps(beyond, typical);
  const auto seen_across = SeenSteps(across, typical);
  if (!SeenEnough(seen_outermost, outermost) || !SeenEnough(seen_beyond, beyond)) return End::kCut;
  if (SeenEnough(seen_across, across) && GoesOn(seen_beyond, seen_across)) return End::kGoesOn;
  return ShareBetween(seen_beyond, 0.3, 3) <= 1 / 3.0 ? End::kSeen : End::kDoubtful;
}

// The median over all rows and columns of squares of how they alternate; 0 where one does not.
double TypicalStep(const SquareSteps& steps, const Squares& s) {
  std::vector<std::vector<double>> lines;
  std::vector<double> strengths;
  const auto add = [&](const std::vector<double>& all) {
    auto line = SeenSteps(all, 1);
    if (line.size() < kLeastSteps) return;
    strengths.push_back(Median(line));
    lines.push_back(std::move(line));
  };
  for (int r = 0; r < s.rows; ++r) add(steps.Along(s.column, s.row + r, false, s.columns));
  for (int c = 0; c < s.columns; ++c) add(steps.Along(s.column + c, s.row, true, s.rows));
  const double typical = strengths.empty() ? 0 : Median(strengths);
  if (typical == 0) return 0;
  const bool all = std::all_of(lines.begin(), lines.end(), [&](const auto& line) {
    return Alternates(SeenSteps(line, typical));
  });
  return all ? typical : 0;
}

std::string Size(const Target& target) {
  return std::to_string(target.corners_x()) + "x" + std::to_string(target.corners_y()) +
         " inner corners";
}

}  // namespace

int CornersInside(const cv::Size& image, const GridModel& model, const PatternMatch& match,
                  const Target& target) {
  int inside = 0;
  for (int row = match.row; row < match.row + match.rows(target); ++row) {
    for (int column = match.column; column < match.column + match.columns(target); ++column) {
      const Eigen::Vector2d place = model.At(column, row);
      const Eigen::Vector2d reach = CornerReach(model.Steps(column, row));
      const bool seen = ((place - reach).array() >= 1).all() &&
                        place.x() + reach.x() <= image.width - 2 &&
                        place.y() + reach.y() <= image.height - 2;
      inside += seen ? 1 : 0;
    }
  }
  return inside;
}

std::optional<std::string> WhyNotPartial(const cv::Mat& grey, const GridModel& model,
                                         const PatternMatch& match, const Target& target) {
  const Squares squares{match.column - 1, match.row - 1, match.columns(target) + 1,
                        match.rows(target) + 1};
  const SquareSteps steps(grey, model, {squares.column, squares.column + squares.columns},
                          {squares.row, squares.row + squares.rows}, kMargin);
  const double typical = TypicalStep(steps, squares);
  if (typical == 0) return std::nullopt;
  std::array<End, 4> ends;
  const auto lines = EndsOf(squares);
  for (std::size_t i = 0; i < 4; ++i) ends[i] = Judge(steps, lines[i], typical);
  for (const End end : ends) {
    if (end == End::kGoesOn) return "it has more than " + Size(target);
    if (end == End::kDoubtful) return "where it ends cannot be told from what lies beside it";
  }
  for (const std::size_t i : {0U, 2U}) {
    if (ends[i] != End::kSeen && ends[i + 1] != End::kSeen) {
      return "neither of two opposite ends of it is seen";
    }
  }
  return "";
}

std::vector<PatternMatch> PartialCandidates(const cv::Mat& grey, const GridModel& model,
                                            const CornerGrid& grid, const Target& target,
                                            std::string* why) {
  Range columns;
  Range rows;
  for (const auto& corner : grid) {
    columns.Add(corner.first.first);
    rows.Add(corner.first.second);
  }
  const int corners = target.corners_x() * target.corners_y();
  std::vector<PatternMatch> candidates;
  for (const PatternMatch& match : PlacesIn(columns, rows, kReach, target)) {
    const auto known = CornersIn(match, grid, target).size();
    if (static_cast<double>(known) < kLeastInGrid * corners) continue;
    const int inside = CornersInside(grey.size(), model, match, target);
    if (inside == corners || inside < kLeastInside * corners) continue;
    const auto reason = WhyNotPartial(grey, model, match, target);
    if (!reason) continue;
    if (reason->empty()) candidates.push_back(match);
    if (!reason->empty()) *why = *reason;
  }
  return candidates;
}

}  // namespace rgbdt
