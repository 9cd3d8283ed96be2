#include "tests/study/board_leaves.h"

#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace rgbdt::study {
namespace {

/// The side between two places on the board's plane, one on the board and one beyond: that which
/// both face most plainly. Nothing at the board's corners, where it may be either.
std::optional<int> SideBetween(const TrueBoard& board, const Eigen::Vector2d& in,
                               const Eigen::Vector2d& out) {
  const Eigen::Vector2d middle = 0.5 * (in + out);
  const Eigen::Vector2d step = out - in;
  std::optional<int> best;
  double nearest = 1e9;
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector2d normal = SideNormal(side);
    if (normal.dot(step) < 0.25 * step.norm()) continue;
    const Eigen::Vector2d along(-normal.y(), normal.x());
    if (std::abs(along.dot(middle)) > SideDistance(board, (side + 1) % 4) - 0.25 * step.norm()) {
      continue;
    }
    const double off = std::abs(normal.dot(middle) - SideDistance(board, side));
    if (off > nearest) continue;
    nearest = off;
    best = side;
  }
  return best;
}

class ViewCrossings {
 public:
  ViewCrossings(const TrueBoard& board, double beams_meet_m, const SampledView& view)
      : board_(board), beams_meet_m_(beams_meet_m), view_(view) {
    const BeamWindow& beams = view.beams;
    for (int row = 0; row < beams.rows; ++row) {
      AddLine(beams.At(row, 0), 1, beams.columns, true);
    }
    for (int column = 0; column < beams.columns; ++column) {
      AddLine(beams.At(0, column), static_cast<std::size_t>(beams.columns), beams.rows, false);
    }
    Count();
  }
  const std::vector<Leave>& leaves() const { return leaves_; }

 private:
  // Both ends of the board along a line of beams.
  void AddLine(std::size_t start, std::size_t step, int length, bool along_row) {
    int first = -1;
    int last = -1;
    for (int k = 0; k < length; ++k) {
      if (!view_.beams.on[start + static_cast<std::size_t>(k) * step]) continue;
      if (first < 0) first = k;
      last = k;
    }
    if (last <= first) return;
    const auto at = [&](int k) { return start + static_cast<std::size_t>(k) * step; };
    if (first > 0) Add(at(first), at(first - 1), along_row);
    if (last + 1 < length) Add(at(last), at(last + 1), along_row);
  }

  void Add(std::size_t in, std::size_t out, bool along_row) {
    const Eigen::Vector2d a = Place(in);
    const Eigen::Vector2d b = Place(out);
    const auto side = SideBetween(board_, a, b);
    if (!side) return;
    const auto columns = static_cast<std::size_t>(view_.beams.columns);
    Leave leave;
    leave.last = in;
    leave.side = *side;
    leave.width_m = SideNormal(*side).dot(b - a);
    leave.along_row = along_row;
    leave.gap = along_row ? in % columns : in / columns;
    leaves_.push_back(leave);
  }

  Eigen::Vector2d Place(std::size_t beam) const {
    return MeetBoard(board_, view_.lidar_from_target, view_.beams.directions[beam], beams_meet_m_)
        .place;
  }

  void Count() {
    std::map<std::pair<std::size_t, int>, int> beams;
    std::map<std::tuple<bool, std::size_t, int>, int> gaps;
    for (const Leave& leave : leaves_) {
      ++beams[{leave.last, leave.side}];
      ++gaps[{leave.along_row, leave.gap, leave.side}];
    }
    for (Leave& leave : leaves_) {
      leave.of_beam = beams[{leave.last, leave.side}];
      leave.in_gap = gaps[{leave.along_row, leave.gap, leave.side}];
    }
  }

  const TrueBoard& board_;
  double beams_meet_m_;
  const SampledView& view_;
  std::vector<Leave> leaves_;
};

}  // namespace

std::vector<Leave> LeavesOf(const TrueBoard& board, double beams_meet_m, const SampledView& view) {
  return ViewCrossings(board, beams_meet_m, view).leaves();
}

}  // namespace rgbdt::study
