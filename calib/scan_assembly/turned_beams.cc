#include "calib/scan_assembly/turned_beams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double Wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

// Of angles that lie all over the circle's seam: their differences from one of them.
double CircularMedian(std::vector<double> angles) {
  angles.erase(std::remove_if(angles.begin(), angles.end(), [](double a) { return std::isnan(a); }),
               angles.end());
  if (angles.empty()) return kNan;
  std::vector<double> about;
  about.reserve(angles.size());
  for (const double angle : angles) about.push_back(Wrapped(angle - angles.front()));
  return Wrapped(angles.front() + Median(std::move(about)));
}

Eigen::Vector3d Turned(const Eigen::Vector3d& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

struct Beam {
  double motor_rad = kNan, scan_rad = kNan, range_m = kNan;
};

/// A point taken apart.
class Inverse {
 public:
  explicit Inverse(const Rigid3& motor_from_scanner)
      : scanner_from_motor_(motor_from_scanner.Inverse()),
        normal_(motor_from_scanner.rotation * Eigen::Vector3d::UnitY()),
        offset_(normal_.dot(motor_from_scanner.translation)) {}

  // NaN where the point does not say. Before the axis, the motor's angle about is the azimuth.
  Beam At(const Eigen::Vector3d& point, bool behind) const {
    constexpr double kNear = 0.1;  // [m]
    const double from_axis = point.head<2>().norm();
    const double cosine =
        (offset_ - normal_.z() * point.z()) / (from_axis * normal_.head<2>().norm());
    if (!(from_axis > kNear) || !(std::abs(cosine) < 0.95)) return {};
    const double across = std::acos(cosine);
    Beam beam;
    beam.motor_rad = Wrapped(std::atan2(point.y(), point.x()) -
                             std::atan2(normal_.y(), normal_.x()) + (behind ? -across : across));
    const Eigen::Vector3d in_scanner = scanner_from_motor_ * Turned(point, -beam.motor_rad);
    beam.scan_rad = std::atan2(in_scanner.z(), in_scanner.x());
    beam.range_m = std::hypot(in_scanner.x(), in_scanner.z());
    return beam;
  }

 private:
  Rigid3 scanner_from_motor_;
  Eigen::Vector3d normal_;  // of the scan plane, motor's frame
  double offset_;
};

/// A line's scan angles are first + step * beam.
struct Numbering {
  double first_rad = 0, step_rad = 0;

  double At(int beam) const { return first_rad + step_rad * beam; }
};

// A straight line through the angles at these places that lie near to `numbering`.
Numbering Refined(const Numbering& numbering, const std::vector<double>& places,
                  const std::vector<double>& angles) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off = Wrapped(angles[i] - numbering.first_rad - numbering.step_rad * places[i]);
    if (std::abs(off) > std::abs(numbering.step_rad)) continue;
    n += 1;
    x += places[i];
    y += off;
    xx += places[i] * places[i];
    xy += places[i] * off;
  }
  const double spread = n * xx - x * x;
  if (!(spread > 0)) return numbering;
  const double slope = (n * xy - x * y) / spread;
  return {numbering.first_rad + (y - slope * x) / n, numbering.step_rad + slope};
}

/// The cloud beside the geometry that it was made with.
class Sweep {
 public:
  Sweep(const TurnedScanner& scanner, const Cloud& cloud)
      : cloud_(cloud),
        lever_(scanner.motor_from_scanner.translation),
        inverse_(scanner.motor_from_scanner) {}

  // Of a point's two solutions the one whose scan angle is the beam's.
  Beam At(int line, int beam, const Numbering& numbering) const {
    const Beam ahead = OneAt(line, beam, false), back = OneAt(line, beam, true);
    const double angle = numbering.At(beam);
    const bool is_ahead =
        std::abs(Wrapped(ahead.scan_rad - angle)) < std::abs(Wrapped(back.scan_rad - angle));
    return is_ahead ? ahead : back;
  }

  std::optional<Numbering> Choose() const;
  double Unevenness(const Numbering& numbering) const;

 private:
  Beam OneAt(int line, int beam, bool behind) const;
  std::vector<double> ScanAngles(bool behind) const;
  std::optional<Numbering> NumberingOf(bool rising) const;
  double FromOrigins(const Numbering& numbering) const;

  const Cloud& cloud_;
  Eigen::Vector3d lever_;
  Inverse inverse_;
};

Beam Sweep::OneAt(int line, int beam, bool behind) const {
  const auto i = static_cast<std::size_t>(line) * static_cast<std::size_t>(cloud_.beams) +
                 static_cast<std::size_t>(beam);
  if (!cloud_.IsHit(i)) return {};
  return inverse_.At(cloud_.points[i].cast<double>(), behind);
}

// Of each beam, as if it pointed ahead (or back): on the other side of the vertical it falls again.
std::vector<double> Sweep::ScanAngles(bool behind) const {
  std::vector<double> angles;
  const int every = std::max(1, cloud_.lines / 50);
  for (int beam = 0; beam < cloud_.beams; ++beam) {
    std::vector<double> seen;
    for (int line = 0; line < cloud_.lines; line += every) {
      seen.push_back(OneAt(line, beam, behind).scan_rad);
    }
    angles.push_back(CircularMedian(seen));
  }
  return angles;
}

std::optional<Numbering> Sweep::NumberingOf(bool rising) const {
  const std::vector<double> ahead = ScanAngles(false), back = ScanAngles(true);
  std::vector<double> places, angles, steps;
  for (std::size_t b = 1; b < ahead.size(); ++b) {
    const bool is_ahead = (ahead[b] > ahead[b - 1]) == rising;
    const double step = is_ahead ? ahead[b] - ahead[b - 1] : Wrapped(back[b] - back[b - 1]);
    if (std::isnan(step)) continue;
    places.push_back(static_cast<double>(b));
    angles.push_back(is_ahead ? ahead[b] : back[b]);
    steps.push_back(step);
  }
  Numbering numbering;
  numbering.step_rad = Median(std::move(steps), kNan);
  std::vector<double> firsts;
  for (std::size_t i = 0; i < places.size(); ++i) {
    firsts.push_back(angles[i] - numbering.step_rad * places[i]);
  }
  numbering.first_rad = CircularMedian(firsts);
  if (!(std::abs(numbering.step_rad) > 0) || std::isnan(numbering.first_rad)) return std::nullopt;
  return Refined(numbering, places, angles);
}

// RMS of what a line's motor angles differ from a straight line over its beams, and of the scan
// angles from the numbering [rad].
double Sweep::Unevenness(const Numbering& numbering) const {
  double sum = 0, count = 0;
  const int every = std::max(1, cloud_.lines / 50);
  for (int line = 0; line < cloud_.lines; line += every) {
    std::vector<double> at, motor;
    for (int beam = 0; beam < cloud_.beams; ++beam) {
      const Beam back = At(line, beam, numbering);
      if (std::isnan(back.motor_rad)) continue;
      at.push_back(static_cast<double>(beam) / cloud_.beams - 0.5);
      motor.push_back(motor.empty() ? back.motor_rad
                                    : motor[0] + Wrapped(back.motor_rad - motor[0]));
      sum += std::pow(Wrapped(back.scan_rad - numbering.At(beam)), 2);
    }
    if (at.size() < 3) continue;
    const auto n = static_cast<Eigen::Index>(at.size());
    Eigen::MatrixX2d design(n, 2);
    design.col(0).setOnes();
    design.col(1) = Eigen::Map<const Eigen::VectorXd>(at.data(), n);
    const Eigen::Map<const Eigen::VectorXd> angles(motor.data(), n);
    const Eigen::Matrix2d normal = design.transpose() * design;
    const Eigen::Vector2d fit = normal.inverse() * (design.transpose() * angles);
    sum += (angles - design * fit).squaredNorm();
    count += static_cast<double>(n);
  }
  return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
}

// RMS distance of the lines' origins from where the motor's angle in their middle has them [m].
double Sweep::FromOrigins(const Numbering& numbering) const {
  double sum = 0, count = 0;
  for (int line = 0; line < cloud_.lines; ++line) {
    const Eigen::Vector3d origin = cloud_.origins[static_cast<std::size_t>(line)].cast<double>();
    std::vector<double> motor;
    for (int beam = 0; beam < cloud_.beams; ++beam) {
      const double angle = At(line, beam, numbering).motor_rad;
      if (!std::isnan(angle)) motor.push_back(angle);
    }
    if (motor.empty() || !origin.allFinite()) continue;
    sum += (Turned(lever_, CircularMedian(motor)) - origin).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

std::optional<Numbering> Sweep::Choose() const {
  const auto rising = NumberingOf(true), falling = NumberingOf(false);
  if (!rising || !falling) return std::nullopt;
  const bool has_origins = cloud_.origins.size() == static_cast<std::size_t>(cloud_.lines);
  if (has_origins && lever_.head<2>().norm() > 1e-4) {
    return FromOrigins(*rising) <= FromOrigins(*falling) ? rising : falling;
  }
  constexpr double kRounding = 2e-6;  // [rad] of a cloud's 32-bit coordinates
  return Unevenness(*falling) + kRounding < 0.5 * Unevenness(*rising) ? falling : rising;
}

void RequireOrganised(const Cloud& cloud) {
  if (cloud.organised && cloud.lines > 1 && cloud.beams > 1) return;
  throw InputError(
      "the cloud of " + std::to_string(cloud.size()) +
      " points is not organised as lines x beams: which beam a point came from is needed to take "
      "the cloud apart; write PCD files with the fields line and beam, as rgbdt does");
}

// Angles and elevations of another geometry do not make straight lines.
void RequireEven(double unevenness) {
  constexpr double kMost = 3e-3;  // [rad]
  if (unevenness < kMost) return;
  throw InputError(
      "the cloud was not assembled with this rig's turned_scanner: its beams' angles "
      "come out uneven by " +
      std::to_string(unevenness) + " rad; give the rig file that it was made with");
}

}  // namespace

void AppendLine(const LineScan& line, const std::vector<double>& angles, TurnedBeams* beams) {
  for (std::size_t i = 0; i < line.range.size(); ++i) {
    if (!std::isfinite(line.range[i]) || line.range[i] <= 0) continue;
    beams->motor_rad.push_back(angles[i]);
    beams->scan_rad.push_back(line.first_angle_rad + static_cast<double>(i) * line.angle_step_rad);
    beams->range_m.push_back(static_cast<double>(line.range[i]));
  }
}

bool IsBehind(const TurnedScanner& scanner, double scan_rad) {
  const Eigen::Vector3d in_scanner(std::cos(scan_rad), 0, std::sin(scan_rad));
  return (scanner.motor_from_scanner.rotation * in_scanner).x() < 0;
}

std::vector<Eigen::Vector3d> PointsOf(const TurnedScanner& scanner, const TurnedBeams& beams) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double a = beams.scan_rad[i];
    const Eigen::Vector3d in_scanner =
        beams.range_m[i] * Eigen::Vector3d(std::cos(a), 0, std::sin(a));
    points.push_back(Turned(scanner.motor_from_scanner * in_scanner, beams.motor_rad[i]));
  }
  return points;
}

TurnedBeams BeamsOfCloud(const TurnedScanner& scanner, const Cloud& cloud) {
  RequireOrganised(cloud);
  const Sweep sweep(scanner, cloud);
  const auto numbering = sweep.Choose();
  if (!numbering) {
    throw InputError("the cloud of " + std::to_string(cloud.lines) + " lines has too few hits to " +
                     "tell its beams' angles");
  }
  RequireEven(sweep.Unevenness(*numbering));
  TurnedBeams beams;
  for (int line = 0; line < cloud.lines; ++line) {
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const Beam back = sweep.At(line, beam, *numbering);
      if (std::isnan(back.motor_rad)) continue;
      beams.motor_rad.push_back(back.motor_rad);
      beams.scan_rad.push_back(back.scan_rad);
      beams.range_m.push_back(back.range_m);
    }
  }
  return beams;
}

}  // namespace rgbdt
