#include "calib/solve/internal/degenerate.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kParallelRad = 0.10;  // normals no farther than this from their mean
constexpr double kOnePlaceM = 0.15;    // centres no farther than this from theirs
constexpr double kLooseRad = M_PI / 180;
constexpr double kLooseM = 0.1;

std::string Direction(const Eigen::Vector3d& v) {
  return Format("(%.2f, %.2f, %.2f)", v.x(), v.y(), v.z());
}
std::string PlaceText(const Eigen::Vector3d& v) {
  return Format("x %.1f, y %.1f, z %.1f m", v.x(), v.y(), v.z());
}

// The direction in space that most normals lie along.
Eigen::Vector3d MeanNormal(const std::vector<Rigid3>& boards) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Rigid3& board : boards) sum += board.rotation * Eigen::Vector3d::UnitZ();
  return sum.norm() > 1e-9 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

const char* NameOf(PoseOf of) { return of == PoseOf::kCamera ? "camera" : "LIDAR"; }

// Of the camera's axes, or the reference LIDAR's.
const char* AxisOf(const Eigen::Vector3d& v, PoseOf of) {
  Eigen::Index axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  if (of == PoseOf::kLidar) {
    return axis == 0   ? "reference's x (forward)"
           : axis == 1 ? "reference's y (left)"
                       : "reference's z (up)";
  }
  return axis == 0   ? "camera's x (right)"
         : axis == 1 ? "camera's y (down)"
                     : "camera's z (forward)";
}

}  // namespace

std::string WhyDegenerate(const std::vector<Rigid3>& lidar_from_target, PoseOf of) {
  if (lidar_from_target.empty()) return "no view";
  const Eigen::Vector3d normal = MeanNormal(lidar_from_target);
  double angle = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Rigid3& board : lidar_from_target) {
    const double along = normal.dot(board.rotation * Eigen::Vector3d::UnitZ());
    angle = std::max(angle, std::acos(std::clamp(along, -1.0, 1.0)));
    middle += board.translation / static_cast<double>(lidar_from_target.size());
  }
  double apart = 0;
  for (const Rigid3& board : lidar_from_target) {
    apart = std::max(apart, (board.translation - middle).norm());
  }
  if (lidar_from_target.size() == 1 || angle < kParallelRad) {
    return (lidar_from_target.size() == 1
                ? std::string("only one view")
                : "the board was parallel to itself in all " +
                      std::to_string(lidar_from_target.size()) + " views") +
           "; shifts of the " + NameOf(of) + " across the board's normal " + Direction(normal) +
           " and turns about it (LIDAR frame) are loose. Next: tilt the board by 20 to 40 deg, to "
           "different sides";
  }
  if (apart < kOnePlaceM) {
    return "the board was at one place in all " + std::to_string(lidar_from_target.size()) +
           " views; a turn of the " + NameOf(of) + " about that place (" + PlaceText(middle) +
           ", LIDAR frame) and a shift of it look alike. Next: hold the board nearer, farther, and "
           "to both sides";
  }
  return "";
}

std::string WhyLoose(const Matrix6d& covariance, PoseOf of) {
  const Eigensystem<3> turns = EigensystemOf(Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()));
  const Eigensystem<3> shifts =
      EigensystemOf(Eigen::Matrix3d(covariance.bottomRightCorner<3, 3>()));
  const double turn = std::sqrt(std::max(0.0, turns.values[2]));
  const double shift = std::sqrt(std::max(0.0, shifts.values[2]));
  if (turn <= kLooseRad && shift <= kLooseM) return "";
  const std::string loose = turn / kLooseRad >= shift / kLooseM
                                ? Format("turns about the %s are known to %.1f deg only (1 sigma)",
                                         AxisOf(turns.vectors.col(2), of), turn * 180 / M_PI)
                                : Format("shifts along the %s are known to %.0f mm only (1 sigma)",
                                         AxisOf(shifts.vectors.col(2), of), shift * 1000);
  return loose + "; add views with the board elsewhere and tilted otherwise";
}

}  // namespace rgbdt
