#include "calib/detect/cloud/board_crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kHoleM = 0.12;  // beams missing over less than this leave a hole, not an edge
constexpr double kMergeM = 0.5;  // farther behind than this, returns do not merge

struct Window {
  int first_row, last_row, first_column, last_column;
};

Window Around(const RangeGrid& grid, const PlaneRegion& region) {
  // The region was found at a stride and grows by up to that, and by the beam beyond.
  const int rows = std::max(2, (region.last_row - region.first_row) / 8 + 1);
  const int columns = std::max(6, (region.last_column - region.first_column) / 8 + 1);
  Window w{std::max(0, region.first_row - rows), std::min(grid.rows() - 1, region.last_row + rows),
           region.first_column - columns, region.last_column + columns};
  if (!grid.wraps()) {
    w.first_column = std::max(0, w.first_column);
    w.last_column = std::min(grid.columns() - 1, w.last_column);
  }
  return w;
}

// What a beam says of the plane.
enum class Beam : std::uint8_t { kUnknown, kOn, kNothing, kFar, kBehind, kBefore };

class MemberFinder {
 public:
  MemberFinder(const RangeGrid& grid, const Window& window) : grid_(grid), window_(window) {}

  // Fits the plane to the points near it, twice.
  Plane Refit(Plane plane, const Eigen::Vector3d& middle, double reach, double tolerance) const {
    for (int round = 0; round < 2; ++round) {
      PlaneSums sums;
      ForEach([&](int, int, std::size_t cell) {
        grid_.ForEachPoint(cell, [&](const Eigen::Vector3f& point, std::size_t) {
          const Eigen::Vector3d p = point.cast<double>();
          if (std::abs(plane.Signed(p)) < tolerance && (p - middle).squaredNorm() < reach * reach) {
            sums.Add(p);
          }
        });
      });
      if (sums.count() < 6) return plane;
      plane = sums.Fit();
    }
    return plane;
  }

  void Classify(const Eigen::Vector3d& middle, double reach, double tolerance,
                PlaneMembers* members) {
    const Plane& plane = members->plane;
    const int columns = window_.last_column - window_.first_column + 1;
    width_ = static_cast<std::size_t>(columns);
    const std::size_t n =
        width_ * static_cast<std::size_t>(window_.last_row - window_.first_row + 1);
    beams_.assign(n, Beam::kUnknown);
    flat_.assign(n, Eigen::Vector2d::Zero());
    range_.assign(n, 0);
    slope_.assign(n, Eigen::Vector2d::Zero());
    ForEach([&](int row, int column, std::size_t cell) {
      const auto direction = grid_.Direction(cell);
      if (!direction) return;
      const Eigen::Vector3d origin = grid_.Origin(cell);
      const double towards = plane.normal.dot(*direction);
      if (!(towards < -0.02)) return;  // never meets the plane, or too flatly to tell
      const double range = -plane.Signed(origin) / towards;
      const Eigen::Vector3d meets = origin + range * *direction;
      if ((meets - middle).squaredNorm() > reach * reach) return;
      const std::size_t i = At(row, column);
      flat_[i] = members->frame.Flat(meets);
      range_[i] = range;
      slope_[i] =
          Eigen::Vector2d(members->frame.u.dot(*direction), members->frame.v.dot(*direction)) /
          -towards;
      if (!grid_.IsHit(cell)) {
        beams_[i] = Beam::kNothing;
        return;
      }
      const Eigen::Vector3d p = grid_.Point(cell).cast<double>();
      const double behind = (p - origin).norm() - range;
      if (std::abs(plane.Signed(p)) <= tolerance) {
        beams_[i] = Beam::kOn;
        grid_.ForEachPoint(cell, [&](const Eigen::Vector3f& point, std::size_t index) {
          const Eigen::Vector3d q = point.cast<double>();
          if (std::abs(plane.Signed(q)) > tolerance) return;
          members->points.push_back(q);
          members->flat.push_back(flat_[i]);
          members->row.push_back(row);
          members->index.push_back(index);
        });
      } else if (behind < 0) {
        beams_[i] = Beam::kBefore;
      } else {
        beams_[i] = behind > kMergeM ? Beam::kFar : Beam::kBehind;
        members->through.push_back(flat_[i]);
      }
    });
  }

  void Spacings(PlaneMembers* members) {
    std::vector<double> along, across, column, row;
    double columns = 0;
    const auto measure = [&](std::size_t i, std::size_t next, double cells,
                             std::vector<double>* apart, std::vector<double>* cell) {
      if (next == i || beams_[next] != Beam::kOn) return 0.0;
      apart->push_back((flat_[next] - flat_[i]).norm());
      cell->push_back(apart->back() / cells);
      return cells;
    };
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      if (beams_[i] != Beam::kOn) continue;
      const std::size_t right = Next(i, 1, width_ - 1 - i % width_);
      columns += measure(i, right, static_cast<double>(right - i), &along, &column);
      const std::size_t above =
          Next(i, static_cast<std::ptrdiff_t>(width_), (beams_.size() - 1 - i) / width_);
      measure(i, above, static_cast<double>((above - i) / width_), &across, &row);
    }
    const auto pairs = static_cast<double>(std::max<std::size_t>(1, along.size()));
    members->column_spacing_m = Median(std::move(along));
    members->row_spacing_m = Median(std::move(across));
    column_m_ = Median(std::move(column));
    row_m_ = Median(std::move(row));
    members->beam_m2 = row_m_ * column_m_ * columns / pairs;
  }

  // Crossings along rows (or along columns), with what each stands for of a side across it.
  void Cross(bool along_rows, PlaneMembers* members) const {
    const std::size_t height = beams_.size() / width_;
    const std::size_t lines = along_rows ? height : width_;
    const std::size_t length = along_rows ? width_ : height;
    const std::size_t step = along_rows ? 1 : width_;
    for (std::size_t line = 0; line < lines; ++line) {
      const std::size_t start = line * (along_rows ? width_ : 1);
      CrossLine(start, step, length, along_rows, members);
    }
  }

 private:
  template <typename F>
  void ForEach(F f) const {
    for (int row = window_.first_row; row <= window_.last_row; ++row) {
      for (int column = window_.first_column; column <= window_.last_column; ++column) {
        f(row, column, grid_.Cell(row, column));
      }
    }
  }
  // The next beam, past cells in which none was fired, among `cells` that lie `step` apart; the
  // same one: there is none.
  std::size_t Next(std::size_t i, std::ptrdiff_t step, std::size_t cells) const {
    for (std::size_t k = 1; k <= std::min<std::size_t>(cells, kMostTurns); ++k) {
      const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) +
                                                 static_cast<std::ptrdiff_t>(k) * step);
      if (beams_[next] != Beam::kUnknown) return next;
    }
    return i;
  }
  std::size_t At(int row, int column) const {
    return static_cast<std::size_t>(row - window_.first_row) * width_ +
           static_cast<std::size_t>(column - window_.first_column);
  }

  // Runs of beams on the plane; a hole does not end one.
  void CrossLine(std::size_t start, std::size_t step, std::size_t length, bool along_row,
                 PlaneMembers* members) const {
    std::size_t k = 0;
    while (k < length) {
      if (beams_[start + k * step] != Beam::kOn) {
        ++k;
        continue;
      }
      const std::size_t first = k;
      std::size_t last = k;
      int count = 0;
      for (; k < length; ++k) {
        const std::size_t i = start + k * step;
        if (beams_[i] == Beam::kOn) {
          last = k;
          ++count;
        } else if (beams_[i] != Beam::kUnknown &&
                   (flat_[i] - flat_[start + last * step]).norm() > kHoleM) {
          break;
        }
      }
      if (count < 2) continue;
      const auto onwards = static_cast<std::ptrdiff_t>(step);
      const std::size_t low = start + first * step, high = start + last * step;
      AddCrossing(low, Next(low, -onwards, first), along_row, members);
      AddCrossing(high, Next(high, onwards, length - 1 - last), along_row, members);
    }
  }

  // How much of a side a crossing at a beam stands for: up to the next row (column) that has beams
  // there; those of rings that fire in turn lie beside it.
  double StandsFor(std::size_t i, bool along_row) const {
    const auto holds_beams = [&](std::ptrdiff_t line, std::ptrdiff_t place) {
      const auto width = static_cast<std::ptrdiff_t>(width_);
      const auto height = static_cast<std::ptrdiff_t>(beams_.size()) / width;
      for (std::ptrdiff_t p = place - 1; p <= place + 1; ++p) {
        const std::ptrdiff_t row = along_row ? line : p, column = along_row ? p : line;
        if (row < 0 || row >= height || column < 0 || column >= width) continue;
        if (beams_[static_cast<std::size_t>(row * width + column)] != Beam::kUnknown) return true;
      }
      return false;
    };
    const auto row = static_cast<std::ptrdiff_t>(i / width_);
    const auto column = static_cast<std::ptrdiff_t>(i % width_);
    const std::ptrdiff_t line = along_row ? row : column, place = along_row ? column : row;
    const double cell_m = along_row ? row_m_ : column_m_;
    for (std::ptrdiff_t k = 1; k <= kMostTurns; ++k) {
      if (holds_beams(line - k, place) || holds_beams(line + k, place)) {
        return static_cast<double>(k) * cell_m;
      }
    }
    return cell_m;
  }

  void AddCrossing(std::size_t in, std::size_t out, bool along_row, PlaneMembers* members) const {
    const Beam beam = beams_[out];
    if (in == out || beam == Beam::kUnknown || beam == Beam::kBefore || beam == Beam::kOn) return;
    FlatCrossing crossing;
    const Eigen::Vector2d across = flat_[out] - flat_[in];
    const double length = across.norm();
    if (!(length > 1e-6) || length > 0.6) return;
    crossing.middle = 0.5 * (flat_[in] + flat_[out]);
    crossing.outward = across / length;
    crossing.half_m = 0.5 * length;
    crossing.length_m = StandsFor(in, along_row);
    crossing.range_m = range_[in];
    crossing.slope = slope_[in];
    crossing.kind = beam == Beam::kNothing ? CrossingKind::kNoReturn
                    : beam == Beam::kFar   ? CrossingKind::kFar
                                           : CrossingKind::kMerged;
    crossing.cell = in;
    crossing.along_row = along_row;
    crossing.gap = along_row ? in % width_ : in / width_;
    members->crossings.push_back(crossing);
  }

  const RangeGrid& grid_;
  Window window_;
  std::size_t width_ = 0;
  double row_m_ = 0, column_m_ = 0;  // from cell to cell on the plane
  std::vector<Beam> beams_;
  std::vector<Eigen::Vector2d> flat_;
  std::vector<double> range_;
  std::vector<Eigen::Vector2d> slope_;
};

}  // namespace

PlaneFrame::PlaneFrame(const Plane& plane, const Eigen::Vector3d& near)
    : origin(near - plane.Signed(near) * plane.normal) {
  u = plane.normal.unitOrthogonal();
  v = -plane.normal.cross(u);
}

PlaneMembers FindMembers(const RangeGrid& grid, const PlaneRegion& region,
                         const MemberOptions& options) {
  const double tolerance = std::max(0.03, 3.5 * options.sigma_m);
  MemberFinder finder(grid, Around(grid, region));
  const Plane plane = finder.Refit(region.plane, options.middle, options.fit_reach_m, tolerance);
  PlaneMembers members{plane, PlaneFrame(plane, options.middle), {}, {}, {}, {}, {}, {}, 0, 0};
  finder.Classify(options.middle, options.reach_m, tolerance, &members);
  finder.Spacings(&members);
  finder.Cross(true, &members);
  finder.Cross(false, &members);
  return members;
}

}  // namespace rgbdt
