#pragma once

// Inside calib/scan_assembly only: beams under a geometry, planes through what they met, and what a
// plane that both halves of the scan line saw says about the geometry.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/linear_algebra.h"
#include "calib/model/rigid3.h"
#include "calib/scan_assembly/turned_beams.h"

namespace rgbdt {

// A change of the geometry is a Vector7d, (rx, ry, rz [rad], tx, ty, tz [m], zero [rad]):
// motor_from_scanner = Exp(first six) * estimate, about and along the motor's axes, and the motor's
// true angle less the estimated one.

/// The beams of all sweeps, and where they start and point under the geometry at hand.
class PlacedBeams {
 public:
  /// At most `most` beams: of more, every second, third, ... is taken.
  PlacedBeams(const std::vector<TurnedBeams>& sweeps, const TurnedScanner& guess, std::size_t most);

  void Place(const Rigid3& motor_from_scanner);

  std::size_t size() const { return range_.size(); }
  double range(std::size_t i) const { return range_[i]; }
  /// LIDAR frame.
  const Eigen::Vector3d& origin(std::size_t i) const { return origin_[i]; }
  const Eigen::Vector3d& direction(std::size_t i) const { return direction_[i]; }
  Eigen::Vector3d Point(std::size_t i) const { return origin_[i] + range_[i] * direction_[i]; }
  /// A vector of the LIDAR frame in the motor's, which turns.
  Eigen::Vector3d InMotor(std::size_t i, const Eigen::Vector3d& v) const {
    const double c = motor_[i].x(), s = motor_[i].y();
    return {c * v.x() + s * v.y(), -s * v.x() + c * v.y(), v.z()};
  }
  /// Which half of the scan line: fired away from where the motor points, not towards it.
  bool behind(std::size_t i) const { return behind_[i]; }
  int sweep(std::size_t i) const { return sweep_[i]; }
  /// Where the scanner's height cuts the motor's axis, LIDAR frame.
  const Eigen::Vector3d& centre() const { return centre_; }

 private:
  std::vector<Eigen::Vector2d> motor_, scan_;  // cosine and sine
  std::vector<double> range_;
  std::vector<bool> behind_;
  std::vector<int> sweep_;
  std::vector<Eigen::Vector3d> origin_, direction_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};

using BeamList = std::vector<std::uint32_t>;

/// A plane through beams' ends: normal . (p - centre) = 0. Noise lies along the beam, so what is
/// fitted is the range at which a beam meets the plane, not the distance of a noisy point from it.
struct BeamPlane {
  Eigen::Vector3d normal, centre;
  BeamList beams;   ///< those that lie on it
  double chi2 = 0;  ///< of their ranges, whitened
  double dof() const { return static_cast<double>(beams.size()) - 3; }

  /// Range at which a beam meets the plane, less its own [m]; NaN where it hardly meets it.
  double Misfit(const PlacedBeams& all, std::uint32_t beam) const;
};

/// The plane of nearly all of these beams; nothing where they do not lie on one. `sigma_m` of a
/// range; `slack`: how much larger than its mean chi2 may be.
std::optional<BeamPlane> FitPlane(const PlacedBeams& all, const BeamList& beams, double sigma_m,
                                  double slack);

/// Fits a plane that is near to all of its beams, none left out.
void RefitPlane(const PlacedBeams& all, double sigma_m, BeamPlane* plane);

/// Gauss-Newton's normal equations of the geometry, with planes eliminated.
struct ScanEquations {
  Matrix7d information = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();  ///< the step solves information * step = gradient

  /// Adds what a plane's beams say, its own three unknowns eliminated (Schur complement).
  void Add(const PlacedBeams& all, const BeamPlane& plane, double sigma_m, double weight);
};

/// The information that the noise of a plane's normal feigns: a wrong normal makes a shift along
/// the plane look like one across it. Its mean, to be taken off what ScanEquations has: little
/// beside what a surface tells, all there is of what it does not tell.
Matrix7d FeignedInformation(const PlacedBeams& all, const BeamPlane& plane, double sigma_m);

}  // namespace rgbdt
