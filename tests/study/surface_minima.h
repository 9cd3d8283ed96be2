#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace rgbdt::study {

/// Values on a square grid of 2 steps + 1 places a side, from -1 to 1 along both axes.
struct Surface {
  int steps = 0;
  std::vector<double> values;  ///< by first coordinate, then by second

  int side() const { return 2 * steps + 1; }
  double At(int i, int j) const { return values[static_cast<std::size_t>(i * side() + j)]; }
  Eigen::Vector2d Place(int i, int j) const {
    return Eigen::Vector2d(i - steps, j - steps) / steps;
  }
};

/// A place of the grid lower than its eight neighbours, and where it goes down to from there. On
/// the grid a narrow slanted valley is a row of hollows: all of them end at its one bottom.
struct Hollow {
  int i = 0, j = 0;
  Eigen::Vector2d end{0, 0};
  double value = 0;  ///< at the end
};

/// All hollows but those on the border. `function` is what the surface shows: downhill from each,
/// in any direction, in steps from the grid's width down to a thousandth of it.
std::vector<Hollow> FindHollows(const Surface& surface,
                                const std::function<double(const Eigen::Vector2d&)>& function);

}  // namespace rgbdt::study
