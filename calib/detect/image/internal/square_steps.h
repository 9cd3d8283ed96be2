#pragma once

#include <algorithm>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/detect/image/internal/grid_model.h"

namespace rgbdt {

/// Lowest and highest of some columns or rows.
struct Range {
  int low = std::numeric_limits<int>::max();
  int high = std::numeric_limits<int>::min();

  void Add(int value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// How much lighter a square of even column + row is than the next, at the edge between them. The
/// step itself counts and not what is farther away: samples on either side, their slope taken off.
/// The square of a column and row lies between the corner of these and the next of both.
class SquareSteps {
 public:
  /// `columns`, `rows`: of the outermost corners; `margin`: so many squares beyond are looked at.
  SquareSteps(const cv::Mat& grey, const GridModel& model, Range columns, Range rows, int margin);

  /// Between the square of that column and row and the one to the right of it or, `down`, below.
  /// NaN: not seen.
  double At(int column, int row, bool down) const;

  /// Along a row or, `down`, column of squares.
  std::vector<double> Along(int column, int row, bool down, int squares) const;

  /// From the squares of a row (`down`) or column to the next below or to the right.
  std::vector<double> Across(int column, int row, bool down, int squares) const;

 private:
  int left_, top_;
  cv::Mat across_, down_;
};

/// The steps that were seen, as parts of what is typical.
std::vector<double> SeenSteps(const std::vector<double>& steps, double typical);

/// Which part of the values lies between the two.
double ShareBetween(const std::vector<double>& values, double low, double high);

/// Of a row's or column's steps, as a part of what is typical: whether it alternates as the pattern
/// does. A hand may cover some squares; light may fall off along the board.
bool Alternates(const std::vector<double>& steps);

/// Whether steps along the row or column beyond an end, and those across to it, as a part of what
/// is typical, are a checkerboard's. Stricter than within: what lies beside a board may happen to
/// go up and down, as a roller door does, but half of the outermost squares look like the border
/// beyond them.
bool GoesOn(const std::vector<double>& along, const std::vector<double>& across);

}  // namespace rgbdt
