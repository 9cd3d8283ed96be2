#include "calib/methods/bearing_angle/angle_pose.h"

#include <Eigen/Geometry>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Polynomial = Eigen::Matrix<double, 5, 1>;  // coefficients of 1, y, .., y^4
using Points = std::vector<Eigen::Vector3d>;

Polynomial Linear(double constant, double slope) {
  Polynomial p = Polynomial::Zero();
  p[0] = constant;
  p[1] = slope;
  return p;
}

// Up to the fourth degree; there is nothing beyond.
Polynomial Times(const Polynomial& a, const Polynomial& b) {
  Polynomial product = Polynomial::Zero();
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; i + k < 5; ++k) product[i + k] += a[i] * b[k];
  }
  return product;
}

// Three points at distances s_i, s_j, s_k keep the law of cosines between each two:
// s_i^2 + s_j^2 - 2 c_ij s_i s_j = d_ij. With s_j = s_i (c_ij + a) and s_k = s_i (c_ik + b) the two
// that hold i are a^2 = A and b^2 = B, linear in y = 1 / s_i^2; the third one is
// K + p a + q b - r a b = 0. Squaring a and b away leaves
// (K^2 + p^2 A - r^2 A B - q^2 B)^2 - 4 A (p K + q r B)^2 = 0.
struct Triangle {
  double c_ij, c_ik, c_jk;  // cosines between directions
  double d_ij, d_ik, d_jk;  // squared distances between points

  Polynomial InInverseSquare() const {
    const Polynomial a = Linear(c_ij * c_ij - 1, d_ij);
    const Polynomial b = Linear(c_ik * c_ik - 1, d_ik);
    const Polynomial k =
        Linear(2 * c_ij * c_ij + 2 * c_ik * c_ik - 2 * c_jk * c_ij * c_ik - 2, d_ij + d_ik - d_jk);
    const double p = 2 * (c_ij - c_jk * c_ik);
    const double q = 2 * (c_ik - c_jk * c_ij);
    const double r = 2 * c_jk;
    const Polynomial ab = Times(a, b);
    const Polynomial left = Times(k, k) + p * p * a - r * r * ab - q * q * b;
    const Polynomial right = p * k + q * r * b;
    return Times(left, left) - 4 * Times(a, Times(right, right));
  }
};

// Squared distance of point i from the camera; nothing where it is not told.
std::optional<double> SquaredDistance(const Points& points, const Points& directions,
                                      std::size_t i) {
  Eigen::Matrix<double, 5, 5> squares = Eigen::Matrix<double, 5, 5>::Zero();
  for (std::size_t j = 0; j < points.size(); ++j) {
    for (std::size_t k = j + 1; k < points.size(); ++k) {
      if (j == i || k == i) continue;
      const Triangle triangle{
          directions[i].dot(directions[j]),      directions[i].dot(directions[k]),
          directions[j].dot(directions[k]),      (points[i] - points[j]).squaredNorm(),
          (points[i] - points[k]).squaredNorm(), (points[j] - points[k]).squaredNorm()};
      // In y = 1 / x of (1, y, .., y^4), so in x of (x^4, .., 1).
      const Polynomial in_x = triangle.InInverseSquare().reverse().normalized();
      if (in_x.allFinite()) squares += in_x * in_x.transpose();
    }
  }
  const Eigen::Matrix<double, 5, 1> powers = EigensystemOf(squares).vectors.col(0);
  const double x = powers.head<4>().dot(powers.tail<4>()) / powers.head<4>().squaredNorm();
  if (!(x > 0) || !std::isfinite(x)) return std::nullopt;
  return x;
}

// The same with lengths in units of the distance itself, where the powers of x are of one size.
std::optional<double> DistanceOf(const Points& points, const Points& directions, std::size_t i) {
  constexpr int kRounds = 3;
  double unit = 0;
  for (const Eigen::Vector3d& point : points) {
    unit += 2 * (point - points[i]).norm() / static_cast<double>(points.size());
  }
  for (int round = 0; round < kRounds; ++round) {
    Points scaled;
    scaled.reserve(points.size());
    for (const Eigen::Vector3d& point : points) scaled.emplace_back(point / unit);
    const std::optional<double> x = SquaredDistance(scaled, directions, i);
    if (!x) return std::nullopt;
    unit *= std::sqrt(*x);
  }
  return unit;
}

}  // namespace

std::optional<Rigid3> PoseFromAngles(const Points& points, const Points& directions) {
  if (points.size() < 5) return std::nullopt;
  std::vector<std::size_t> told;
  std::vector<double> distance;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<double> found = DistanceOf(points, directions, i);
    if (!found) continue;
    told.push_back(i);
    distance.push_back(*found);
  }
  if (told.size() < 3) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(told.size());
  Eigen::Matrix3Xd in_lidar(3, count);
  Eigen::Matrix3Xd in_camera(3, count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto at = static_cast<std::size_t>(n);
    in_lidar.col(n) = points[told[at]];
    in_camera.col(n) = distance[at] * directions[told[at]];
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(in_lidar, in_camera, false);
  if (!motion.allFinite()) return std::nullopt;
  return Rigid3{Eigen::Quaterniond(Eigen::Matrix3d(motion.topLeftCorner<3, 3>())).normalized(),
                motion.topRightCorner<3, 1>()};
}

}  // namespace rgbdt
