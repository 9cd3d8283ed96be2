#include "calib/detect/cloud/cloud_sanity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "calib/detect/cloud/internal/ring_rows.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// No LIDAR's points lie so far, or so near, in the median.
constexpr double kFarthestM = 400, kNearestM = 0.1;

std::string WhyUnitIsOff(const Cloud& cloud) {
  std::vector<double> ranges;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.IsHit(i)) ranges.push_back(cloud.points[i].cast<double>().norm());
  }
  if (ranges.empty()) return "";
  const double range = Median(std::move(ranges));
  if (range < kFarthestM && range > kNearestM) return "";
  return Format(
      "half of the cloud's points lie beyond %s m: its unit seems to be %s, and clouds are read "
      "in "
      "metres; convert it",
      Fixed(range, range > 1 ? 0 : 4).c_str(),
      range > 1 ? "the millimetre" : "the kilometre, or it was scaled");
}

// How far beams of one ring differ in their angle with an axis [rad]: RMS over all of them.
double ScatterAbout(int axis, const Cloud& cloud) {
  struct Sums {
    double count = 0, sum = 0, squares = 0;
  };
  std::map<std::uint16_t, Sums> rings;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    const double angle = std::asin(std::clamp(p[axis] / p.norm(), -1.0, 1.0));
    Sums& sums = rings[cloud.ring[i]];
    ++sums.count;
    sums.sum += angle;
    sums.squares += angle * angle;
  }
  double all = 0;
  double count = 0;
  for (const auto& [ring, sums] : rings) {
    all += std::max(0.0, sums.squares - sums.sum * sums.sum / sums.count);
    count += sums.count;
  }
  return std::sqrt(all / std::max(1.0, count));
}

std::string WhyAxesAreOff(const Cloud& cloud) {
  constexpr double kTurnsRad = 0.02;  // about an axis: less; the firing's own offsets are in it
  constexpr double kClearly = 5;
  if (cloud.ring.size() != cloud.size()) return "";
  const std::array<double, 3> scatter = {ScatterAbout(0, cloud), ScatterAbout(1, cloud),
                                         ScatterAbout(2, cloud)};
  const auto about = std::min_element(scatter.begin(), scatter.end()) - scatter.begin();
  if (about == 2 || scatter[static_cast<std::size_t>(about)] > kTurnsRad ||
      scatter[2] < kClearly * scatter[static_cast<std::size_t>(about)]) {
    return "";
  }
  return Format(
      "the cloud's rings turn about its %c axis: its axes seem to be %s, and clouds are read as x "
      "forward, y left, z up; turn it",
      about == 0 ? 'x' : 'y', about == 1 ? "a camera's (x right, y down, z forward)" : "others");
}

// Coarser than a millimetre or two beams of a ring share a place, and rings are not told apart.
std::string WhyRounded(const Cloud& cloud) {
  for (const double step : {0.1, 0.05, 0.02, 0.01, 0.005}) {
    std::size_t all = 0;
    std::size_t even = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const Eigen::Array3d steps = cloud.points[i].cast<double>().array() / step;
      all += 1;
      even += ((steps - steps.round()).abs() < 0.01).all() ? 1 : 0;
    }
    if (100 * even < 99 * all) continue;
    return Format(
        "the cloud's coordinates are rounded to %g mm, which is more than its beams are apart; "
        "write them with 4 decimals",
        1000 * step);
  }
  return "";
}

// Sines of elevations as they are seen from a point, about an axis: each less its ring's mean.
struct Cones {
  Eigen::Vector3d apex = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  // Over apex and tilt of the axis, and the residual. RMS of the residuals.
  double Equations(const std::map<std::uint16_t, std::vector<Eigen::Vector3d>>& rings,
                   Eigen::Matrix<double, 6, 6>* h) const {
    h->setZero();
    double count = 0;
    for (const auto& [ring, points] : rings) {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      for (const Eigen::Vector3d& p : points) {
        const double range = (p - apex).norm();
        const Eigen::Vector3d u = (p - apex) / range;
        const double sine = axis.dot(u);
        Eigen::Matrix<double, 6, 1> row;
        row << (sine * u - axis) / range, axis.cross(u).head<2>(), sine;
        *h += row * row.transpose();
        sum += row;
      }
      *h -= sum * sum.transpose() / static_cast<double>(points.size());
      count += static_cast<double>(points.size());
    }
    return std::sqrt((*h)(5, 5) / count);
  }
};

// Whether rings are cones about another point than the cloud's origin.
std::string WhyFrameIsOff(const Cloud& cloud) {
  constexpr double kNearM = 2, kScatter = 0.02, kClearly = 4, kFarM = 0.3;
  constexpr std::size_t kMostPoints = 20000;
  constexpr int kRounds = 20;
  if (cloud.ring.size() != cloud.size()) return "";
  std::map<std::uint16_t, std::vector<Eigen::Vector3d>> rings;
  for (std::size_t i = 0; i < cloud.size(); i += 1 + cloud.size() / kMostPoints) {
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    if (cloud.IsHit(i) && p.norm() > kNearM) rings[cloud.ring[i]].push_back(p);
  }
  if (rings.size() < 4) return "";
  Cones cones;
  Eigen::Matrix<double, 6, 6> h;
  const double given = cones.Equations(rings, &h);
  double found = given;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Matrix<double, 5, 1> step =
        SolveSymmetric(Eigen::Matrix<double, 5, 5>(h.topLeftCorner<5, 5>()),
                       Eigen::Matrix<double, 5, 1>(-h.topRightCorner<5, 1>()));
    if (!step.allFinite()) return "";
    cones.apex += step.head<3>();
    cones.axis = (cones.axis + Eigen::Vector3d(step[3], step[4], 0).cross(cones.axis)).normalized();
    found = cones.Equations(rings, &h);
  }
  if (!(given > kScatter) || !(given > kClearly * found) || !(cones.apex.norm() > kFarM)) return "";
  return Format(
      "the cloud's rings meet at %.2f %.2f %.2f m, not at its origin: it seems to be in another "
      "frame than the LIDAR's own (the vehicle's?), in which clouds are read; give it as the "
      "LIDAR's "
      "driver does",
      cones.apex.x(), cones.apex.y(), cones.apex.z());
}

}  // namespace

std::string WhyCloudIsOff(const Cloud& cloud) {
  for (const auto& why_off : {WhyUnitIsOff, WhyRounded, WhyAxesAreOff, WhyFrameIsOff}) {
    std::string why = why_off(cloud);
    if (!why.empty()) return why;
  }
  return "";
}

std::string WhyCutOut(const Cloud& cloud, const Target& target) {
  constexpr double kDiagonals = 0.75, kPart = 0.9;
  std::array<std::vector<double>, 3> along;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      along[static_cast<std::size_t>(axis)].push_back(double{cloud.points[i][axis]});
    }
  }
  const Eigen::Vector3d middle(Median(along[0]), Median(along[1]), Median(along[2]));
  const double near = kDiagonals * std::hypot(target.width_m, target.height_m);
  std::size_t count = 0;
  for (std::size_t i = 0; i < along[0].size(); ++i) {
    const Eigen::Vector3d point(along[0][i], along[1][i], along[2][i]);
    count += (point - middle).norm() < near ? 1 : 0;
  }
  const double part = static_cast<double>(count) / static_cast<double>(along[0].size());
  if (part < kPart) return "";
  return Format(
      "hardly anything but the board is in the cloud (%.0f%% of its points lie within %.1f m): it "
      "seems to be cut out of a whole one; give whole clouds, as the beams beside the board show "
      "its sides",
      100 * part, near);
}

std::string WhyNoRings(const RangeGrid& grid) {
  const Cloud& cloud = grid.cloud();
  if (!grid.scattered() || cloud.ring.size() == cloud.size()) return "";
  if (!LieInRows(AnglesOf(cloud))) return "";
  return "the points lie in rings, as a spinning LIDAR's do, but their elevations do not tell "
         "which is which, and there is no field `ring`: write the clouds with it, as the LIDAR's "
         "driver has it";
}

}  // namespace rgbdt
