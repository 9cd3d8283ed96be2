#include "calib/solve/board_model.h"

#include <algorithm>
#include <cmath>

#include "calib/model/range_errors.h"

namespace rgbdt {
namespace {

constexpr double kRobust = 3;  // sigmas; farther off, a residual counts less

// Of the beam to a point; none where it goes straight up.
double TanElevation(const Eigen::Vector3d& point) {
  const double flat = point.head<2>().norm();
  return flat > 0 ? point.z() / flat : 0;
}

double HalfExtent(const Target& target, int side) {
  return side % 2 == 1 ? target.width_m / 2 : target.height_m / 2;
}

}  // namespace

std::array<double, kSharedUnknowns> BoardPriors::Means() const {
  std::array<double, kSharedUnknowns> means{};
  means[kThickness] = thickness_m;
  return means;
}

double BoardPriors::Sigma(int unknown) const {
  if (unknown <= kMergedShift) return class_sigma_rad;
  if (unknown == kThickness) return thickness_sigma_m;
  if (unknown == kRangeOffset) return range_offset_sigma_m;
  if (unknown == kBeamsMeet) return beams_meet_sigma_m;
  if (unknown == kFringe) return fringe_sigma_m;
  if (unknown == kBowX || unknown == kTwist || unknown == kBowY) return bow_sigma_m;
  if (unknown == kPrintWidth || unknown == kPrintHeight) return print_sigma;
  return outline_sigma_m;
}

Eigen::Vector3d BowOf(const std::array<double, kSharedUnknowns>& shared) {
  return {shared[kBowX], shared[kTwist], shared[kBowY]};
}

double BowAt(const Target& target, const std::array<double, kSharedUnknowns>& shared,
             const Eigen::Vector2d& at) {
  return target.BowFactors(at).dot(BowOf(shared));
}

Eigen::RowVector2d BowSlope(const Target& target, const std::array<double, kSharedUnknowns>& shared,
                            const Eigen::Vector2d& at) {
  const double x = 2 / target.width_m;
  const double y = 2 / target.height_m;
  return {2 * x * x * at.x() * shared[kBowX] + x * y * at.y() * shared[kTwist],
          2 * y * y * at.y() * shared[kBowY] + x * y * at.x() * shared[kTwist]};
}

Target PrintedAs(const Target& target, const std::array<double, kSharedUnknowns>& shared) {
  Target printed = target;
  printed.print_scale = {1 + shared[kPrintWidth], 1 + shared[kPrintHeight]};
  return printed;
}

RangeTerms::Parts RangeTerms::PartsOf(const PointGroup& group) const {
  Parts parts;
  const auto add = [&](std::size_t term, double weight) {
    if (weight > 0) parts.all[parts.count++] = {term, weight};
  };
  const auto ring = std::lower_bound(rings.begin(), rings.end(), group.ring);
  if (ring != rings.end() && *ring == group.ring) {
    add(static_cast<std::size_t>(ring - rings.begin()), 1);
  }
  if (octaves > 0) {
    const OctavePlace place = PlaceOf(group.log2_intensity, first_octave, octaves);
    add(rings.size() + place.lower, 1 - place.share);
    add(rings.size() + place.lower + 1, place.share);
  }
  return parts;
}

Eigen::Vector2d OutwardOf(int side) {
  switch (side) {
    case 0:
      return {0, -1};
    case 1:
      return {1, 0};
    case 2:
      return {0, 1};
    default:
      return {-1, 0};
  }
}

double RobustWeight(double squared) {
  return squared <= kRobust * kRobust ? 1.0 : kRobust * kRobust / squared;
}

double RobustCost(double squared) {
  constexpr double kLimit = kRobust * kRobust;
  return squared <= kLimit ? squared : kLimit * (1 + std::log(squared / kLimit));
}

CrossingResidual ResidualOf(const Target& target, const BoardPriors& priors,
                            const Crossing& crossing, const Rigid3& lidar_from_target,
                            const std::array<double, kSharedUnknowns>& shared, double side_shift) {
  CrossingResidual out;
  out.by_target.setZero();
  const Eigen::Matrix3d rotation = lidar_from_target.rotation.toRotationMatrix();
  const Eigen::Vector3d beam = rotation.transpose() * crossing.point.normalized();
  const Eigen::Vector3d by_meet = -TanElevation(crossing.point) * rotation.row(2).transpose();
  const Eigen::Vector3d origin =
      shared[kBeamsMeet] * by_meet - rotation.transpose() * lidar_from_target.translation;
  if (!(beam.z() > 0.02)) return out;  // the beam does not meet the board's front
  const double range = -origin.z() / beam.z();
  const Eigen::Vector2d at = (origin + range * beam).head<2>();
  const Eigen::Vector2d slope = beam.head<2>() / beam.z();
  const Eigen::Vector2d outward = OutwardOf(crossing.side);
  const double sideways = slope.dot(outward) / std::sqrt(1 + slope.squaredNorm());
  const double upright = std::sqrt(1 - sideways * sideways);
  // A beam that meets the plane at a slant is drawn out on it; a rim that faces the LIDAR is seen
  // beside the front.
  out.per_rad = range / upright;
  out.per_fringe = 1 / upright;
  out.per_thickness = std::max(0.0, -slope.dot(outward));
  const auto kind = static_cast<std::size_t>(crossing.kind) - 1;
  const double shift = shared[kNoReturnShift + kind] + side_shift;
  out.beyond_m = outward.dot(at) - HalfExtent(target, crossing.side) -
                 shared[static_cast<std::size_t>(kOutlineTop + crossing.side)] -
                 out.per_rad * shift - out.per_fringe * shared[kFringe] -
                 out.per_thickness * shared[kThickness];
  const double across = outward.dot(slope);
  const Eigen::Vector2d at_by_meet = by_meet.head<2>() - by_meet.z() * slope;
  out.by_beams_meet = outward.dot(at_by_meet) + shift / upright * by_meet.z() / beam.z();
  // The board moves by delta under the beam: a point at (x, y, 0) goes the other way in its axes,
  // and the beam meets the plane elsewhere by the slope.
  // A rim that lies behind the mean plane is met there farther in.
  out.per_bow = across * target.BowFactors(at).transpose();
  const double bow = BowAt(target, shared, at);
  const Eigen::RowVector2d bow_slope = BowSlope(target, shared, at);
  out.beyond_m += across * bow;
  Eigen::Matrix<double, 2, 6> at_by_target;
  at_by_target << slope * at.y(), -slope * at.x(), Eigen::Vector2d(at.y(), -at.x()),
      -Eigen::Matrix2d::Identity(), slope;
  out.by_target = outward.transpose() * at_by_target;
  // The same motion changes the range, the slant and how much of the rim is seen.
  const Eigen::Vector3d turned = Eigen::Vector3d(outward.x(), outward.y(), 0).cross(beam);
  Eigen::Matrix<double, 1, 6> by_range, by_sideways, by_depth;  // by_depth: of beam.z
  by_range << at.y(), -at.x(), 0, 0, 0, 1;
  by_range /= beam.z();
  by_sideways << turned.transpose(), 0, 0, 0;
  by_depth << -beam.y(), beam.x(), 0, 0, 0, 0;
  out.by_target -= (shift * by_range + (shift * range + shared[kFringe]) * sideways /
                                           (upright * upright) * by_sideways) /
                   upright;
  const Eigen::Matrix<double, 1, 6> by_across = (by_sideways - across * by_depth) / beam.z();
  if (out.per_thickness > 0) out.by_target += shared[kThickness] * by_across;
  out.by_target += bow * by_across + across * bow_slope * at_by_target;
  out.by_beams_meet += across * bow_slope.dot(at_by_meet);
  // At the range at which it was seen.
  const double scale = crossing.point.norm() / range;
  out.by_target = scale * (out.by_target - out.beyond_m / range * by_range);
  out.by_beams_meet = scale * (out.by_beams_meet + out.beyond_m / range * by_meet.z() / beam.z());
  out.per_outline = scale;
  for (double* metres : {&out.beyond_m, &out.per_rad, &out.per_thickness, &out.per_fringe}) {
    *metres *= scale;
  }
  out.per_bow *= scale;
  const double blur = priors.blur_rad * out.per_rad;
  out.sigma_m = std::sqrt(crossing.half_width_m * crossing.half_width_m / 3 + blur * blur);
  return out;
}

PlaneResidual ResidualOf(const CloudEdges& cloud, const Rigid3& lidar_from_target,
                         double range_offset_m, double beams_meet_m) {
  const Eigen::Matrix3d rotation = lidar_from_target.rotation.toRotationMatrix();
  const Eigen::Vector3d n = rotation.col(2);
  const double range = cloud.centre.norm();
  const Eigen::Vector3d along = cloud.centre / range;
  const Eigen::Matrix3d across = (Eigen::Matrix3d::Identity() - along * along.transpose()) / range;
  // Of the points as they are: in `scatter` what rows share counts less.
  const Eigen::Matrix3d spread = cloud.raw_scatter.topLeftCorner<3, 3>() / cloud.raw_scatter(3, 3);
  const Eigen::Vector3d mean_beam =
      along + (along * (1.5 * along.dot(spread * along) - 0.5 * spread.trace()) - spread * along) /
                  (range * range);
  const Eigen::Vector3d lean = across * n - n.dot(across * n) * n;
  // Of tan(elevation): its change with the point, whose part along n is noise, too.
  const double flat = cloud.centre.head<2>().norm();
  const double rise = TanElevation(cloud.centre);
  const Eigen::Vector3d by_point =
      Eigen::Vector3d(-rise * cloud.centre.x() / flat, -rise * cloud.centre.y() / flat, 1) / flat;
  const Eigen::Vector3d rise_lean = by_point - n.dot(by_point) * n;
  const Eigen::Vector3d from_target =
      cloud.centre + range_offset_m * mean_beam - lidar_from_target.translation;
  PlaneResidual out;
  out.x << n + range_offset_m * lean - beams_meet_m * n.z() * rise_lean,
      n.dot(from_target) - beams_meet_m * n.z() * rise;
  out.by.setZero();
  const auto turn = [&](int column, const Eigen::Vector3d& by_n) {
    const Eigen::Vector3d lean_by_n =
        across * by_n - n.dot(across * n) * by_n - 2 * n.dot(across * by_n) * n;
    const Eigen::Vector3d rise_by_n =
        by_n.z() * rise_lean - n.z() * (by_n.dot(by_point) * n + n.dot(by_point) * by_n);
    out.by.col(column) << by_n + range_offset_m * lean_by_n - beams_meet_m * rise_by_n,
        by_n.dot(from_target) - beams_meet_m * by_n.z() * rise;
  };
  turn(0, -rotation.col(1));
  turn(1, rotation.col(0));
  out.by(3, 2) = -1;
  out.by.col(3) << lean, n.dot(mean_beam);
  out.by.col(4) << -n.z() * rise_lean, -n.z() * rise;
  return out;
}

std::optional<double> SigmaByCloud(const Target& target, const BoardPriors& priors,
                                   const Crossing& crossing, const CloudEdges& cloud,
                                   const std::array<double, kSharedUnknowns>& shared) {
  const CrossingResidual r =
      ResidualOf(target, priors, crossing, cloud.pose->sensor_from_target, shared, 0);
  if (!(r.per_rad > 0)) return std::nullopt;
  return r.sigma_m;
}

}  // namespace rgbdt
