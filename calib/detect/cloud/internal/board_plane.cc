#include "calib/detect/cloud/internal/board_plane.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/range_errors.h"

namespace rgbdt {
namespace {

// Sums over the points, row by row: sum of w j j' and w j z, less what the correlated noise of rows
// takes off.
template <int kSize>
struct RowSums {
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Matrix h = Matrix::Zero();
  Vector g = Vector::Zero();

  template <typename W, typename J, typename Z>
  RowSums(const std::vector<int>& rows, const RowNoise& noise, W w_of, J j_of, Z z_of) {
    for (std::size_t first = 0; first < rows.size();) {
      Vector sum = Vector::Zero();
      double sum_z = 0;
      double sum_w = 0;
      std::size_t i = first;
      for (; i < rows.size() && rows[i] == rows[first]; ++i) {
        const Vector j = j_of(i);
        const double w = w_of(i);
        const double wz = w * z_of(i);
        h.noalias() += w * j * j.transpose();
        g.noalias() += wz * j;
        sum += w * j;
        sum_z += wz;
        sum_w += w;
      }
      const double correlated = noise.Correlated(sum_w);
      h.noalias() -= correlated * sum * sum.transpose();
      g.noalias() -= correlated * sum_z * sum;
      first = i;
    }
  }
};

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// One-way analysis of variance of distances from the plane, rows against points; a bias of rows
// only where chance hardly makes one. `alike`: by how much noise that neighbours share makes the
// mean of a row scatter more than that of independent points.
RowNoise NoiseOf(const std::vector<int>& rows, const std::vector<double>& off,
                 const std::vector<double>& weight, double alike, double least) {
  double within = 0;
  double between = 0;
  double count = 0;
  for (std::size_t first = 0; first < rows.size();) {
    double weights = 0;
    double sum = 0;
    double squares = 0;
    std::size_t i = first;
    for (; i < rows.size() && rows[i] == rows[first]; ++i) {
      weights += weight[i];
      sum += weight[i] * off[i];
      squares += weight[i] * off[i] * off[i];
    }
    within += squares - sum * sum / weights;
    between += sum * sum / weights;
    count += 1;
    first = i;
  }
  const auto n = static_cast<double>(rows.size());
  const RowNoise independent{std::sqrt(alike) * std::max(std::sqrt((within + between) / n), least),
                             0};
  if (count < 4 || n - count < 10) return independent;
  const double within_mean = alike * std::max(within / (n - count), least * least);
  const double between_mean = between / (count - 2);  // the plane took two of the rows' freedoms
  const double chance = 1 + 4 * std::sqrt(2 / (count - 2));
  if (between_mean < chance * within_mean) return independent;
  return {std::sqrt(within_mean), std::sqrt((between_mean - within_mean) * count / n)};
}

// Points of about one brightness, dark first: octaves, put together until they are many.
std::vector<std::vector<std::size_t>> ByBrightness(const std::vector<double>& log2_intensity) {
  constexpr std::size_t kMany = 25;
  std::map<double, std::vector<std::size_t>> octaves;
  for (std::size_t i = 0; i < log2_intensity.size(); ++i) {
    octaves[std::floor(log2_intensity[i])].push_back(i);
  }
  std::vector<std::vector<std::size_t>> out;
  for (const auto& [octave, members] : octaves) {
    if (out.empty() || out.back().size() >= kMany) out.emplace_back();
    out.back().insert(out.back().end(), members.begin(), members.end());
  }
  if (out.size() > 1 && out.back().size() < kMany) {
    out[out.size() - 2].insert(out[out.size() - 2].end(), out.back().begin(), out.back().end());
    out.pop_back();
  }
  return out;
}

// Takes the mean of each class off.
void Centre(const std::vector<std::vector<std::size_t>>& classes, std::vector<double>* off) {
  for (const std::vector<std::size_t>& members : classes) {
    double mean = 0;
    for (const std::size_t i : members) mean += (*off)[i];
    mean /= static_cast<double>(members.size());
    for (const std::size_t i : members) (*off)[i] -= mean;
  }
}

std::vector<std::vector<std::size_t>> ByRow(const std::vector<int>& rows) {
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i] != rows[i - 1]) out.emplace_back();
    out.back().push_back(i);
  }
  return out;
}

// One over the variance that a point's brightness has, one in the mean. `off` about the means of
// rows and brightness. What few points say is drawn towards what all say.
std::vector<double> WeightsOf(const std::vector<std::vector<std::size_t>>& classes,
                              const std::vector<double>& off, double least) {
  constexpr double kDrawn = 10;  // points
  std::vector<double> weight(off.size(), 1);
  if (classes.size() < 2) return weight;
  double all = 0;
  for (const double value : off) all += value * value;
  all /= static_cast<double>(off.size());
  for (const std::vector<std::size_t>& members : classes) {
    double squares = kDrawn * all;
    for (const std::size_t i : members) squares += off[i] * off[i];
    const double variance = squares / (kDrawn + static_cast<double>(members.size()));
    for (const std::size_t i : members) weight[i] = 1 / std::max(variance, least * least);
  }
  const double mean = Sum(weight) / static_cast<double>(weight.size());
  for (double& value : weight) value /= mean;
  return weight;
}

// By how much more the variance of a smooth function of the points is than were their noise
// independent: (1 + r) / (1 - r), r the correlation of neighbours in a row (a process of first
// order). r from how differences grow from neighbours to the third next, (1 - r^3) / (1 - r), into
// which a board's bend and a ring's offset do not come. One where chance may make it.
double AlikeOf(const std::vector<std::vector<std::size_t>>& rows, const std::vector<double>& off,
               const std::vector<double>& weight) {
  constexpr double kMostCorrelation = 0.8;
  constexpr std::size_t kApart = 3;
  double next = 0;
  double apart = 0;
  double pairs = 0;
  for (const std::vector<std::size_t>& row : rows) {
    for (std::size_t k = kApart; k < row.size(); ++k) {
      const auto z = [&](std::size_t i) { return std::sqrt(weight[row[i]]) * off[row[i]]; };
      next += std::pow(z(k) - z(k - 1), 2);
      apart += std::pow(z(k) - z(k - kApart), 2);
      pairs += 1;
    }
  }
  if (!(next > 0)) return 1;
  const double growth = apart / next;
  if (growth < 1 + 4 * std::sqrt(2 / pairs)) return 1;
  const double r = std::min((std::sqrt(4 * growth - 3) - 1) / 2, kMostCorrelation);
  return (1 + r) / (1 - r);
}

template <typename W, typename PointOf>
Eigen::Matrix4d ScatterOf(const std::vector<int>& rows, const RowNoise& noise, W w_of,
                          PointOf point_of) {
  const auto q_of = [&](std::size_t i) {
    Eigen::Vector4d q;
    q << point_of(i), 1;
    return q;
  };
  return RowSums<4>(rows, noise, w_of, q_of, [](std::size_t) { return 0.0; }).h;
}

}  // namespace

double RowNoise::Correlated(double weights) const {
  const double between = between_m * between_m;
  return between / (within_m * within_m + weights * between);
}

BoardPlane::BoardPlane(const Plane& near, const PlaneFrame& frame, const BoardPoints& points,
                       double least_sigma_m)
    : near_(near),
      frame_(frame),
      points_(points),
      least_sigma_m_(least_sigma_m),
      weight_(points.points.size(), 1) {
  plane_ = FitAlongRays();
  const auto rows = ByRow(points_.row);
  const auto classes = ByBrightness(points_.log2_intensity);
  std::vector<double> off = OffPlane();
  Centre(classes, &off);
  Centre(rows, &off);
  weight_ = WeightsOf(classes, off, least_sigma_m);
  alike_ = AlikeOf(rows, off, weight_);
  if (classes.size() > 1) plane_ = FitAlongRays();
  noise_ = NoiseOf(points_.row, OffPlane(), weight_, alike_, least_sigma_m);
  if (noise_.between_m > 0) plane_ = FitAlongRays();
}

std::vector<double> BoardPlane::OffPlane() const {
  std::vector<double> off;
  off.reserve(points_.points.size());
  for (std::size_t i = 0; i < points_.points.size(); ++i) {
    off.push_back(plane_.Signed(AlongNormal(i)));
  }
  return off;
}

// The plane of least squares, noise lying along the beams. The plane of least distances would lean
// by sigma^2 sin cos / extent^2 (angles of incidence), since noise moves the points of a slanted
// board along it, too. Where the beams meet the plane is free of it.
Plane BoardPlane::FitAlongRays() const {
  const auto j_of = [&](std::size_t i) {
    return Eigen::Vector3d(points_.flat[i].x(), points_.flat[i].y(), 1);
  };
  const auto z_of = [&](std::size_t i) { return near_.Signed(points_.points[i]); };
  const auto w_of = [&](std::size_t i) { return weight_[i]; };
  const RowSums<3> sums(points_.row, noise_, w_of, j_of, z_of);
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
  return ScatterOf(
      points_.row, noise_, [&](std::size_t i) { return weight_[i]; },
      [&](std::size_t i) -> Eigen::Vector3d { return AlongNormal(i) - centre; });
}

Eigen::Matrix4d BoardPlane::RawScatter(const Eigen::Vector3d& centre) const {
  return ScatterOf(
      points_.row, {1, 0}, [](std::size_t) { return 1.0; },
      [&](std::size_t i) -> Eigen::Vector3d { return points_.points[i] - centre; });
}

BoardPlane::Groups BoardPlane::GroupsAbout(const Eigen::Vector3d& centre, const Cloud& cloud,
                                           bool one_laser) const {
  const bool lasers = !one_laser && NamesLasers(cloud);
  std::map<std::pair<int, double>, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < points_.points.size(); ++i) {
    const int ring = lasers ? cloud.ring[points_.index[i]] : -1;
    members[{ring, std::floor(points_.log2_intensity[i])}].push_back(i);
  }
  Groups out;
  // Lines of a turned scanner share no laser: what a line is off by is taken off as noise.
  const RowNoise noise = lasers ? RowNoise{1, 0} : noise_;
  const std::vector<double> all_off = OffPlane();
  double squares = 0;
  double freedom = 0;
  for (const auto& entry : members) {
    const std::vector<std::size_t>& group = entry.second;
    const auto n = static_cast<double>(group.size());
    double log2_sum = 0;
    double weights = 0;
    double off_sum = 0;
    double off_squares = 0;
    std::vector<int> rows;
    for (const std::size_t i : group) {
      log2_sum += points_.log2_intensity[i];
      weights += weight_[i];
      off_sum += weight_[i] * all_off[i];
      off_squares += weight_[i] * all_off[i] * all_off[i];
      rows.push_back(points_.row[i]);
    }
    squares += off_squares - off_sum * off_sum / weights;
    freedom += n - 1;
    out.groups.push_back(
        {entry.first.first, log2_sum / n,
         ScatterOf(
             rows, noise, [&](std::size_t k) { return weight_[group[k]]; },
             [&](std::size_t k) -> Eigen::Vector3d { return AlongNormal(group[k]) - centre; })});
  }
  constexpr double kLeastFreedom = 10;
  out.sigma_m = lasers && freedom >= kLeastFreedom
                    ? std::max(least_sigma_m_, std::sqrt(alike_ * squares / freedom))
                    : noise_.within_m;
  return out;
}

}  // namespace rgbdt
