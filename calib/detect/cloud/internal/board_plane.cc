#include "calib/detect/cloud/internal/board_plane.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/range_errors.h"

namespace rgbdt {
namespace {

// Sums over the points, row by row: sum of j j' and j z, less what the correlated noise of rows
// takes off.
template <int kSize>
struct RowSums {
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Matrix h = Matrix::Zero();
  Vector g = Vector::Zero();

  template <typename J, typename Z>
  RowSums(const std::vector<int>& rows, const RowNoise& noise, J j_of, Z z_of) {
    for (std::size_t first = 0; first < rows.size();) {
      Vector sum = Vector::Zero();
      double sum_z = 0;
      std::size_t i = first;
      for (; i < rows.size() && rows[i] == rows[first]; ++i) {
        const Vector j = j_of(i);
        const double z = z_of(i);
        h.noalias() += j * j.transpose();
        g.noalias() += z * j;
        sum += j;
        sum_z += z;
      }
      const double correlated = noise.Correlated(static_cast<double>(i - first));
      h.noalias() -= correlated * sum * sum.transpose();
      g.noalias() -= correlated * sum_z * sum;
      first = i;
    }
  }
};

// One-way analysis of variance of distances from the plane, rows against points; a bias of rows
// only where chance hardly makes one.
RowNoise NoiseOf(const std::vector<int>& rows, const std::vector<double>& off, double least) {
  double within = 0;
  double between = 0;
  double count = 0;
  for (std::size_t first = 0; first < rows.size();) {
    double sum = 0;
    double squares = 0;
    std::size_t i = first;
    for (; i < rows.size() && rows[i] == rows[first]; ++i) {
      sum += off[i];
      squares += off[i] * off[i];
    }
    const auto n = static_cast<double>(i - first);
    within += squares - sum * sum / n;
    between += sum * sum / n;
    count += 1;
    first = i;
  }
  const auto n = static_cast<double>(rows.size());
  const double all = std::sqrt((within + between) / n);
  if (count < 4 || n - count < 10) return {std::max(all, least), 0};
  const double within_mean = std::max(within / (n - count), least * least);
  const double between_mean = between / (count - 2);  // the plane took two of the rows' freedoms
  const double chance = 1 + 4 * std::sqrt(2 / (count - 2));
  if (between_mean < chance * within_mean) return {std::max(all, least), 0};
  return {std::sqrt(within_mean), std::sqrt((between_mean - within_mean) * count / n)};
}

template <typename PointOf>
Eigen::Matrix4d ScatterOf(const std::vector<int>& rows, const RowNoise& noise, PointOf point_of) {
  const auto q_of = [&](std::size_t i) {
    Eigen::Vector4d q;
    q << point_of(i), 1;
    return q;
  };
  return RowSums<4>(rows, noise, q_of, [](std::size_t) { return 0.0; }).h;
}

}  // namespace

double RowNoise::Correlated(double points) const {
  const double between = between_m * between_m;
  return between / (within_m * within_m + points * between);
}

BoardPlane::BoardPlane(const Plane& near, const PlaneFrame& frame, const BoardPoints& points,
                       double least_sigma_m)
    : near_(near), frame_(frame), points_(points), least_sigma_m_(least_sigma_m) {
  plane_ = FitAlongRays();
  std::vector<double> off;
  for (std::size_t i = 0; i < points_.points.size(); ++i) {
    off.push_back(plane_.Signed(AlongNormal(i)));
  }
  noise_ = NoiseOf(points_.row, off, least_sigma_m);
  if (noise_.between_m > 0) plane_ = FitAlongRays();
}

// The plane of least squares, noise lying along the beams. The plane of least distances would lean
// by sigma^2 sin cos / extent^2 (angles of incidence), since noise moves the points of a slanted
// board along it, too. Where the beams meet the plane is free of it.
Plane BoardPlane::FitAlongRays() const {
  const auto j_of = [&](std::size_t i) {
    return Eigen::Vector3d(points_.flat[i].x(), points_.flat[i].y(), 1);
  };
  const auto z_of = [&](std::size_t i) { return near_.Signed(points_.points[i]); };
  const RowSums<3> sums(points_.row, noise_, j_of, z_of);
  const Eigen::Vector3d lean = SolveSymmetric(sums.h, sums.g);
  Plane plane;
  plane.normal = (near_.normal - lean.x() * frame_.u - lean.y() * frame_.v).normalized();
  plane.offset = plane.normal.dot(frame_.origin + lean.z() * near_.normal);
  return plane;
}

// Where a point's beam meets the plane, moved along the normal by the point's distance.
Eigen::Vector3d BoardPlane::AlongNormal(std::size_t i) const {
  return frame_.Solid(points_.flat[i]) + near_.Signed(points_.points[i]) * near_.normal;
}

Eigen::Matrix4d BoardPlane::Scatter(const Eigen::Vector3d& centre) const {
  return ScatterOf(points_.row, noise_,
                   [&](std::size_t i) -> Eigen::Vector3d { return AlongNormal(i) - centre; });
}

Eigen::Matrix4d BoardPlane::RawScatter(const Eigen::Vector3d& centre) const {
  return ScatterOf(points_.row, {1, 0},
                   [&](std::size_t i) -> Eigen::Vector3d { return points_.points[i] - centre; });
}

BoardPlane::Groups BoardPlane::GroupsAbout(const Eigen::Vector3d& centre,
                                           const Cloud& cloud) const {
  const bool lasers = NamesLasers(cloud);
  const bool bright = cloud.intensity.size() == cloud.size();
  const auto log2_of = [&](std::size_t i) {
    return bright ? Log2Intensity(cloud.intensity[points_.index[i]]) : 0;
  };
  std::map<std::pair<int, double>, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < points_.points.size(); ++i) {
    const int ring = lasers ? cloud.ring[points_.index[i]] : -1;
    members[{ring, std::floor(log2_of(i))}].push_back(i);
  }
  Groups out;
  // Lines of a turned scanner share no laser: what a line is off by is taken off as noise.
  const RowNoise noise = lasers ? RowNoise{1, 0} : noise_;
  double squares = 0;
  double freedom = 0;
  for (const auto& [key, group] : members) {
    const auto n = static_cast<double>(group.size());
    double log2_sum = 0;
    double off_sum = 0;
    double off_squares = 0;
    std::vector<int> rows;
    for (const std::size_t i : group) {
      const double off = plane_.Signed(AlongNormal(i));
      log2_sum += log2_of(i);
      off_sum += off;
      off_squares += off * off;
      rows.push_back(points_.row[i]);
    }
    squares += off_squares - off_sum * off_sum / n;
    freedom += n - 1;
    const auto point_of = [&](std::size_t k) -> Eigen::Vector3d {
      return AlongNormal(group[k]) - centre;
    };
    out.groups.push_back({key.first, log2_sum / n, ScatterOf(rows, noise, point_of)});
  }
  constexpr double kLeastFreedom = 10;
  out.sigma_m = lasers && freedom >= kLeastFreedom
                    ? std::max(least_sigma_m_, std::sqrt(squares / freedom))
                    : noise_.within_m;
  return out;
}

}  // namespace rgbdt
