#include "calib/scan_assembly/internal/beam_planes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kGrazing = 0.15;     // cosine of 81 degrees: a beam there says little of the plane
constexpr double kParallel = 0.05;    // far beyond, so that no beam comes and goes between steps
constexpr double kGate = 4;           // sigmas
constexpr double kMostOutside = 0.1;  // part of the beams
constexpr double kLeastWidth = 2.5;   // of what is to be a plane, in its thickness; both RMS
constexpr std::size_t kLeastBeams = 12;

// A plane's own unknowns are small turns about two axes in it, and a shift along its normal.
struct PlaneAxes {
  explicit PlaneAxes(const Eigen::Vector3d& normal)
      : u(normal.unitOrthogonal()), v(normal.cross(u)) {}

  Eigen::Vector3d u, v;
};

Eigen::Matrix3d ScatterOf(const PlacedBeams& all, const BeamList& beams, Eigen::Vector3d* centre) {
  centre->setZero();
  for (const auto i : beams) *centre += all.Point(i);
  *centre /= static_cast<double>(beams.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto i : beams) {
    const Eigen::Vector3d off = all.Point(i) - *centre;
    scatter += off * off.transpose();
  }
  return scatter / static_cast<double>(beams.size());
}

// The plane of least distances: only to begin with.
std::optional<BeamPlane> FirstPlane(const PlacedBeams& all, const BeamList& beams) {
  BeamPlane plane;
  const Eigensystem<3> axes = EigensystemOf(ScatterOf(all, beams, &plane.centre));
  plane.normal = axes.vectors.col(0);
  if (axes.values(1) < kLeastWidth * kLeastWidth * axes.values(0)) return std::nullopt;
  const Eigen::Vector3d sight = (plane.centre - all.origin(beams[0])).normalized();
  if (!(std::abs(plane.normal.dot(sight)) > kGrazing)) return std::nullopt;
  return plane;
}

void TakeNear(const PlacedBeams& all, const BeamList& beams, double most_m, BeamPlane* plane) {
  plane->beams.clear();
  for (const auto i : beams) {
    if (std::abs(plane->normal.dot(all.direction(i))) < kGrazing) continue;
    if (std::abs(plane->Misfit(all, i)) < most_m) plane->beams.push_back(i);
  }
}

}  // namespace

PlacedBeams::PlacedBeams(const std::vector<TurnedBeams>& sweeps, const TurnedScanner& guess,
                         std::size_t most) {
  std::size_t total = 0;
  for (const TurnedBeams& sweep : sweeps) total += sweep.size();
  const std::size_t every = total / std::max<std::size_t>(1, most) + 1;
  std::size_t count = 0;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const TurnedBeams& beams = sweeps[s];
    for (std::size_t i = 0; i < beams.size(); ++i) {
      if (count++ % every != 0) continue;
      const double a = beams.scan_rad[i];
      motor_.emplace_back(std::cos(beams.motor_rad[i]), std::sin(beams.motor_rad[i]));
      scan_.emplace_back(std::cos(a), std::sin(a));
      range_.push_back(beams.range_m[i]);
      sweep_.push_back(static_cast<int>(s));
      behind_.push_back(IsBehind(guess, a));
    }
  }
  Place(guess.motor_from_scanner);
}

void PlacedBeams::Place(const Rigid3& motor_from_scanner) {
  origin_.resize(size());
  direction_.resize(size());
  const Eigen::Matrix3d r = motor_from_scanner.rotation.toRotationMatrix();
  const Eigen::Vector3d& lever = motor_from_scanner.translation;
  for (std::size_t i = 0; i < size(); ++i) {
    const double c = motor_[i].x(), s = motor_[i].y();
    const Eigen::Vector3d d = scan_[i].x() * r.col(0) + scan_[i].y() * r.col(2);
    direction_[i] = {c * d.x() - s * d.y(), s * d.x() + c * d.y(), d.z()};
    origin_[i] = {c * lever.x() - s * lever.y(), s * lever.x() + c * lever.y(), lever.z()};
  }
  centre_ = {0, 0, lever.z()};
}

double BeamPlane::Misfit(const PlacedBeams& all, std::uint32_t beam) const {
  const double slant = normal.dot(all.direction(beam));
  if (std::abs(slant) < kParallel) return std::numeric_limits<double>::quiet_NaN();
  return normal.dot(centre - all.origin(beam)) / slant - all.range(beam);
}

void RefitPlane(const PlacedBeams& all, double sigma_m, BeamPlane* plane) {
  constexpr int kSteps = 2;  // the range at which a beam meets a plane is nearly linear in it
  for (int step = 0; step <= kSteps; ++step) {
    const PlaneAxes axes(plane->normal);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    plane->chi2 = 0;
    for (const auto i : plane->beams) {
      const double misfit = plane->Misfit(all, i) / sigma_m;
      if (std::isnan(misfit)) continue;
      plane->chi2 += misfit * misfit;
      const Eigen::Vector3d off =
          all.Point(i) + misfit * sigma_m * all.direction(i) - plane->centre;
      // d range: of turning the normal by a u + b v, and of shifting the plane.
      const Eigen::Vector3d row = Eigen::Vector3d(-axes.u.dot(off), -axes.v.dot(off), 1) /
                                  (plane->normal.dot(all.direction(i)) * sigma_m);
      information += row * row.transpose();
      gradient -= row * misfit;
    }
    if (step == kSteps) break;
    const Eigen::Vector3d change = SolveSymmetric(information, gradient);
    if (!change.allFinite()) break;
    plane->centre += change.z() * plane->normal;
    plane->normal = (plane->normal + change.x() * axes.u + change.y() * axes.v).normalized();
  }
}

std::optional<BeamPlane> FitPlane(const PlacedBeams& all, const BeamList& beams, double sigma_m,
                                  double slack) {
  if (beams.size() < kLeastBeams) return std::nullopt;
  auto plane = FirstPlane(all, beams);
  if (!plane) return std::nullopt;
  const double enough = (1 - kMostOutside) * static_cast<double>(beams.size());
  for (const double gate : {3 * kGate, kGate, kGate}) {
    TakeNear(all, beams, gate * sigma_m, &*plane);
    if (static_cast<double>(plane->beams.size()) < enough) return std::nullopt;
    RefitPlane(all, sigma_m, &*plane);
  }
  if (plane->chi2 < plane->dof() * slack * (1 + 5 * std::sqrt(2 / plane->dof()))) return plane;
  return std::nullopt;
}

namespace {

using PlaneByGeometry = Eigen::Matrix<double, 3, 7>;

/// A beam's whitened range: how it changes with the geometry and with its plane.
struct Row {
  Vector7d geometry;
  Eigen::Vector3d plane;
};

// A point in the motor's frame moves by r x p + t: n . that is r . (p x n) + t . n, and the beam
// meets the plane that much earlier.
Vector7d ByGeometry(const PlacedBeams& all, std::uint32_t beam, const Eigen::Vector3d& met,
                    const Eigen::Vector3d& normal) {
  const Eigen::Vector3d point = all.InMotor(beam, met), n = all.InMotor(beam, normal);
  const Eigen::Vector3d turn = point.cross(n);
  return (Vector7d() << -turn, -n, -turn.z()).finished();
}

// `normal` is the plane's own for the equations themselves.
Row RowOf(const PlacedBeams& all, std::uint32_t beam, const BeamPlane& plane, const PlaneAxes& axes,
          const Eigen::Vector3d& normal, double misfit_m, double sigma_m) {
  const Eigen::Vector3d met = all.Point(beam) + misfit_m * all.direction(beam);
  const Eigen::Vector3d off = met - plane.centre;
  const double scale = 1 / (plane.normal.dot(all.direction(beam)) * sigma_m);
  return {scale * ByGeometry(all, beam, met, normal),
          scale * Eigen::Vector3d(-axes.u.dot(off), -axes.v.dot(off), 1)};
}

/// Sums over a plane's beams, the plane eliminated at the end.
struct Sums {
  Matrix7d geometry = Matrix7d::Zero();
  PlaneByGeometry mixed = PlaneByGeometry::Zero();
  Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();

  void Add(const Row& row) {
    geometry += row.geometry * row.geometry.transpose();
    mixed += row.plane * row.geometry.transpose();
    plane += row.plane * row.plane.transpose();
  }
  Matrix7d Eliminated() const {
    return geometry - mixed.transpose() * SolveSymmetric(plane, mixed);
  }
};

}  // namespace

void ScanEquations::Add(const PlacedBeams& all, const BeamPlane& plane, double sigma_m,
                        double weight) {
  const PlaneAxes axes(plane.normal);
  Sums sums;
  Vector7d of_geometry = Vector7d::Zero();
  Eigen::Vector3d of_plane = Eigen::Vector3d::Zero();
  for (const auto i : plane.beams) {
    const double misfit = plane.Misfit(all, i);
    if (std::isnan(misfit)) continue;
    const Row row = RowOf(all, i, plane, axes, plane.normal, misfit, sigma_m);
    sums.Add(row);
    of_geometry -= row.geometry * (misfit / sigma_m);
    of_plane -= row.plane * (misfit / sigma_m);
  }
  information += weight * sums.Eliminated();
  gradient +=
      weight * (of_geometry - sums.mixed.transpose() * SolveSymmetric(sums.plane, of_plane));
}

Matrix7d FeignedInformation(const PlacedBeams& all, const BeamPlane& plane, double sigma_m) {
  const PlaneAxes axes(plane.normal);
  Sums by_u, by_v;
  for (const auto i : plane.beams) {
    const double misfit = plane.Misfit(all, i);
    if (std::isnan(misfit)) continue;
    by_u.Add(RowOf(all, i, plane, axes, axes.u, misfit, sigma_m));
    by_v.Add(RowOf(all, i, plane, axes, axes.v, misfit, sigma_m));
  }
  const Eigen::Matrix3d covariance = by_u.plane.inverse();
  return covariance(0, 0) * by_u.Eliminated() + covariance(1, 1) * by_v.Eliminated();
}

}  // namespace rgbdt
