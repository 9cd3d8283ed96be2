#include "calib/model/intrinsics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

void CheckView(const IntrinsicsView& view, std::size_t expected) {
  if (view.corners.size() != expected) {
    throw InputError("intrinsics: view " + view.name + " has " +
                     std::to_string(view.corners.size()) + " corners; the target has " +
                     std::to_string(expected));
  }
  for (const Eigen::Vector2d& corner : view.corners) {
    if (!corner.allFinite()) {
      throw InputError("intrinsics: view " + view.name + " has a corner that is not finite");
    }
  }
}

}  // namespace

void IntrinsicsInput::Check() const {
  if (width < 1 || height < 1) {
    throw InputError("intrinsics: the image's size is " + std::to_string(width) + "x" +
                     std::to_string(height) + " px; expected positive numbers");
  }
  if (target.corners_x() < 2 || target.corners_y() < 2 || !(target.square_m > 0)) {
    throw InputError("intrinsics: the target has " + std::to_string(target.squares_x) + "x" +
                     std::to_string(target.squares_y) + " squares of " +
                     std::to_string(target.square_m) +
                     " m; expected at least 3x3 and a positive size");
  }
  const auto expected = static_cast<std::size_t>(target.corners_x() * target.corners_y());
  for (const IntrinsicsView& view : views) CheckView(view, expected);
}

std::vector<std::string> ImageCoverage::EmptyParts() const {
  static const char* const kNames[9] = {"top left",    "top",    "top right",
                                        "left",        "middle", "right",
                                        "bottom left", "bottom", "bottom right"};
  int cells[9] = {};
  int held[9] = {};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int part = 3 * row / rows * 3 + 3 * column / columns;
      ++cells[part];
      if (Holds(column, row)) ++held[part];
    }
  }
  std::vector<std::string> empty;
  for (int part = 0; part < 9; ++part) {
    if (2 * held[part] < cells[part]) empty.emplace_back(kNames[part]);
  }
  return empty;
}

double IntrinsicsResult::Sigma(int i) const {
  if (i >= covariance.rows()) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(0.0, covariance(i, i)));
}

int IntrinsicsResult::ViewsUsed() const {
  return static_cast<int>(
      std::count_if(views.begin(), views.end(),
                    [](const IntrinsicsViewFit& view) { return view.rejected.empty(); }));
}

LensUncertainty UncertaintyOf(const IntrinsicsResult& result,
                              const std::vector<IntrinsicsView>& views) {
  LensUncertainty out;
  const Eigen::MatrixXd& all = result.covariance;
  const Eigen::Index numbers = std::min<Eigen::Index>(all.rows(), kLensNumbers);
  const Eigen::Index rest = all.rows() - numbers;
  if (numbers > 0) {
    Eigen::MatrixXd own = all.topLeftCorner(numbers, numbers);
    if (rest > 0) {
      own -= all.topRightCorner(numbers, rest) *
             SolveSymmetric(Eigen::MatrixXd(all.bottomRightCorner(rest, rest)),
                            Eigen::MatrixXd(all.bottomLeftCorner(rest, numbers)));
    }
    out.covariance.topLeftCorner(numbers, numbers) = 0.5 * (own + own.transpose());
  }
  for (std::size_t v = 0; v < views.size() && v < result.views.size(); ++v) {
    if (result.views[v].rejected.empty()) out.made_from.push_back(MiddleOf(views[v].corners));
  }
  return out;
}

}  // namespace rgbdt
