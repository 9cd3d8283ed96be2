#include "calib/odometry/internal/degeneracy.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt::odometry {
namespace {

constexpr double kScatters = 3;
constexpr std::size_t kLeftOut = 5;     // voxels, and
constexpr std::size_t kOneIn = 10;      // of them
constexpr double kNormalFloor = 0.002;  // [rad] systematic, as rings' offsets make it

constexpr std::array<const char*, 6> kWords = {
    "a turn about the LIDAR's x (roll)", "a turn about the LIDAR's y (pitch)",
    "a turn about the LIDAR's z (yaw)",  "a move along the LIDAR's x (forward)",
    "a move along the LIDAR's y (left)", "a move along the LIDAR's z (up)"};

}  // namespace

void Information::Add(const Evidence& e) {
  const Eigen::Matrix3d rotation = e.middle_from_world.toRotationMatrix();
  const Plane& plane = *e.match.plane;
  Eigen::Matrix3d tilt = plane.normal_covariance;
  tilt += kNormalFloor * kNormalFloor *
          (Eigen::Matrix3d::Identity() - plane.normal * plane.normal.transpose());
  Eigen::Matrix<double, 6, 3> by_normal;
  by_normal << CrossMatrix(e.in_middle) * rotation, rotation;
  Sums& sums = voxels_[{e.match.level, e.match.voxel}];
  sums.all += e.weight * e.slope * e.slope.transpose();
  sums.noise += e.weight * by_normal * tilt * by_normal.transpose();
}

double Information::LeastTold(const Vector6d& delta) const {
  std::vector<double> told;
  double squared = 0;
  for (const auto& [voxel, sums] : voxels_) {
    const double noise = delta.dot(sums.noise * delta);
    told.push_back(delta.dot(sums.all * delta) - noise);
    squared += 2 * noise * noise;
  }
  const std::size_t kept = told.size() - std::min(told.size(), kLeftOut + told.size() / kOneIn);
  std::nth_element(told.begin(), told.begin() + static_cast<std::ptrdiff_t>(kept), told.end());
  double least = -kScatters * std::sqrt(squared);
  for (std::size_t i = 0; i < kept; ++i) least += told[i];
  return least;
}

Directions Information::Told(double lever_m, double limit_m) const {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(1 / lever_m), Eigen::Vector3d::Ones();
  Matrix6d told = Matrix6d::Zero();
  for (const auto& [voxel, sums] : voxels_) told += sums.all - sums.noise;
  const Eigensystem<6> axes =
      EigensystemOf<6>(Matrix6d(unit.asDiagonal() * told * unit.asDiagonal()));
  std::vector<Eigen::Index> told_ones, degenerate_ones;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double least = LeastTold(unit.cwiseProduct(axes.vectors.col(i)));
    (least < 1 / (limit_m * limit_m) ? degenerate_ones : told_ones).push_back(i);
  }
  const auto columns = [&axes](const std::vector<Eigen::Index>& ones) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> picked(6, static_cast<Eigen::Index>(ones.size()));
    for (std::size_t i = 0; i < ones.size(); ++i) {
      picked.col(static_cast<Eigen::Index>(i)) = axes.vectors.col(ones[i]);
    }
    return picked;
  };
  return {columns(told_ones), columns(degenerate_ones)};
}

std::vector<std::string> DegenerateWords(
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& directions) {
  std::vector<std::string> words;
  words.reserve(static_cast<std::size_t>(directions.cols()));
  // How much of each number lies in the directions together: as many numbers as directions.
  const Vector6d share = directions.rowwise().squaredNorm();
  std::array<int, 6> order = {0, 1, 2, 3, 4, 5};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return share[a] > share[b]; });
  for (int i = 0; i < directions.cols(); ++i) {
    words.emplace_back(kWords[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
  }
  return words;
}

}  // namespace rgbdt::odometry
