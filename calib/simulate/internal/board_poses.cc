#include "calib/simulate/internal/board_poses.h"

#include <algorithm>
#include <cmath>

#include "calib/model/errors.h"
#include "calib/simulate/internal/livox.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"

namespace rgbdt::simulate {
namespace {

/// Attempts of a round, and those in which a far board stays as far as it was drawn.
constexpr int kAttempts = 400, kFarAttempts = 100;

/// What a pose is made of. Angles against the line of sight from the LIDAR.
struct PoseNumbers {
  double range = 0, azimuth = 0, elevation = 0;  ///< of the board's centre
  double tilt_axis = 0, tilt = 0, roll = 0;      ///< axis: angle in the board's plane
};

Rigid3 MakePose(const PoseNumbers& n) {
  const Eigen::Vector3d sight(std::cos(n.elevation) * std::cos(n.azimuth),
                              std::cos(n.elevation) * std::sin(n.azimuth), std::sin(n.elevation));
  // Target axes while it faces the LIDAR: x right, y down, z away.
  const Eigen::Vector3d right = sight.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d facing;
  facing << right, sight.cross(right), sight;
  const Eigen::Vector3d axis(std::cos(n.tilt_axis), std::sin(n.tilt_axis), 0);
  Rigid3 pose;
  pose.rotation = Eigen::Quaterniond(facing) * RotationAbout(axis, n.tilt).rotation *
                  RotationAbout(Eigen::Vector3d::UnitZ(), n.roll).rotation;
  pose.rotation.normalize();
  pose.translation = n.range * sight;
  return pose;
}

/// Point `index` of the additive sequence after M. Roberts, in dimension `axis` of 6: evenly spread
/// however many points are taken. `shift` moves all of them.
double Spread(int index, int axis, double shift) {
  constexpr double kRoot = 1.1347241384015195;  // x^7 = x + 1
  const double value = shift + (index + 1) * std::pow(kRoot, -(axis + 1));
  return value - std::floor(value);
}

/// Places on the board: the outline densely, and a grid.
std::vector<Eigen::Vector3d> Places(const BoardOptions& board) {
  std::vector<Eigen::Vector3d> places;
  constexpr int kSteps = 12;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const bool outline = i == 0 || j == 0 || i == kSteps || j == kSteps;
      if (!outline && (i % 3 != 0 || j % 3 != 0)) continue;
      places.emplace_back((double(i) / kSteps - 0.5) * board.width_m,
                          (double(j) / kSteps - 0.5) * board.height_m, 0);
    }
  }
  return places;
}

bool InImage(const CameraRenderer& camera, double margin, const Eigen::Vector3d& point) {
  const auto pixel = camera.lens().Project(camera.camera_from_lidar() * point);
  const double border = margin * camera.options().width;
  return pixel && pixel->x() > border && pixel->y() > border &&
         pixel->x() < camera.options().width - 1 - border &&
         pixel->y() < camera.options().height - 1 - border;
}

bool InSpinningField(const SpinningOptions& spinning, const Eigen::Vector3d& point, double margin) {
  const double elevation = std::atan2(point.z(), point.head<2>().norm());
  return elevation > spinning.elevations_rad.front() + margin &&
         elevation < spinning.elevations_rad.back() - margin;
}

bool InField(const Options& options, const Eigen::Vector3d& point) {
  const double margin = options.pose.sweep_margin_rad;
  const double azimuth = std::atan2(point.y(), point.x());
  const double elevation = std::atan2(point.z(), point.head<2>().norm());
  if (options.livox) return InLivoxField(options.livox->model, point, margin);
  if (options.spinning) return InSpinningField(*options.spinning, point, margin);
  const ScannerOptions& s = options.scanner;
  return azimuth > s.sweep_start_rad + margin &&
         azimuth < s.sweep_start_rad + s.sweep_rad - margin &&
         elevation > s.first_angle_rad + margin &&
         elevation < s.first_angle_rad + s.angle_step_rad * (s.beams - 1) - margin;
}

/// Whether anything of the scene lies within `clearance` of a point: 14 rays tell.
bool Crowded(const World& empty, const Eigen::Vector3d& point, double clearance) {
  if (clearance <= 0) return false;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int axes = std::abs(x) + std::abs(y) + std::abs(z);
        if (axes != 1 && axes != 3) continue;
        const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
        if (empty.caster().Blocked(point, direction, clearance)) return true;
      }
    }
  }
  return false;
}

bool Hidden(const World& empty, const Eigen::Vector3d& sensor, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - sensor;
  return empty.caster().Blocked(sensor, offset.normalized(), offset.norm());
}

/// Why a place on the board does not do for the LIDARs beside the reference; empty: it does.
std::string WhyNotSeenByFurther(const Options& options, const World& empty,
                                const std::vector<Rigid3>& reference_from_lidar,
                                const Eigen::Vector3d& point) {
  for (std::size_t i = 0; i < reference_from_lidar.size(); ++i) {
    const FurtherLidarOptions& lidar = options.further_lidars[i];
    if (!InSpinningField(lidar.spinning, reference_from_lidar[i].Inverse() * point,
                         options.pose.sweep_margin_rad)) {
      return "outside the field of " + lidar.name;
    }
    if (Hidden(empty, reference_from_lidar[i].translation, point))
      return "hidden from " + lidar.name;
  }
  return "";
}

std::vector<Rigid3> FurtherPoses(const Options& options) {
  std::vector<Rigid3> reference_from_lidar;
  for (const FurtherLidarOptions& lidar : options.further_lidars) {
    reference_from_lidar.push_back(DrawReferenceFromLidar(lidar, options.seed));
  }
  return reference_from_lidar;
}

/// Lowest and highest elevation that all spinning LIDARs see, added up.
double TwiceMiddle(const Options& options) {
  double low = options.spinning->elevations_rad.front();
  double high = options.spinning->elevations_rad.back();
  for (const FurtherLidarOptions& lidar : options.further_lidars) {
    low = std::max(low, lidar.spinning.elevations_rad.front());
    high = std::min(high, lidar.spinning.elevations_rad.back());
  }
  return low + high;
}

/// Elevation that later attempts draw closer to: the middle of the LIDARs' field, but no lower than
/// a board may hang.
double MiddleElevation(const Options& options, double range) {
  const bool mid360 = options.livox && options.livox->model == LivoxModel::kMid360;
  if (!options.spinning && !mid360) return 0;
  constexpr double kMid360Middle = 22.5 * kDegree;
  const double twice = mid360 ? 2 * kMid360Middle : TwiceMiddle(options);
  const double radius = 0.5 * std::hypot(options.board.width_m, options.board.height_m);
  const double lowest = options.world.ground_z_m + options.pose.clearance_m + radius;
  const double middle = std::sin(0.5 * twice);
  return std::asin(std::clamp(std::max(middle, lowest / range), -1.0, 1.0));
}

/// Share of the board that lies outside the image of the camera that sees least of it.
double ShareOutside(const BoardOptions& board, const std::vector<CameraRenderer>& cameras,
                    const Rigid3& lidar_from_target) {
  constexpr int kSteps = 24;
  int most = 0;
  for (const CameraRenderer& camera : cameras) {
    int outside = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const int column = i % kSteps;
      const int row = i / kSteps;
      const Eigen::Vector3d place(((column + 0.5) / kSteps - 0.5) * board.width_m,
                                  ((row + 0.5) / kSteps - 0.5) * board.height_m, 0);
      if (!InImage(camera, 0, lidar_from_target * place)) ++outside;
    }
    most = std::max(most, outside);
  }
  return double(most) / (kSteps * kSteps);
}

/// Attempt 0 spreads evenly; later ones draw closer to the middle and to a medium range. Where none
/// of a first round does, a second one begins anew, each pose far from the one before.
PoseNumbers Draw(const Options& options, int index, int number) {
  const bool first_round = number < kAttempts;
  const int attempt = number % kAttempts;
  const PoseOptions& o = options.pose;
  const Noise shifts(options.seed, 0, "pose");
  const Noise jitter(options.seed, index + 1, "pose " + std::to_string(number));
  const bool wholly = o.outside_image == 0;
  const auto spread = [&](int axis, double low, double high) {
    double u = Spread(index, axis, shifts.Uniform(static_cast<std::uint64_t>(axis)));
    if (number > 0) {
      const double reach = wholly && first_round ? 0.1 : 0.5;
      u += reach * jitter.Uniform(static_cast<std::uint64_t>(axis), -1, 1);
      u -= std::floor(u);
    }
    return low + (high - low) * u;
  };
  const double inwards = wholly ? std::pow(0.985, attempt) : 1;
  PoseNumbers n;
  // Near views weigh more in a calibration and are more easily detected: prefer them a little.
  n.range = o.min_range_m +
            (o.max_range_m - o.min_range_m) * std::pow(spread(0, 0, 1), o.near_preference);
  // Two LIDARs' fields, tilted against each other, have room for a board farther away.
  const double share = options.further_lidars.empty() ? 0.4 : 0.7;
  const double medium = o.min_range_m + share * (o.max_range_m - o.min_range_m);
  // A far place has more room than a near one, but the scene may end before it.
  const double far_inwards = wholly ? std::pow(0.985, std::max(0, attempt - kFarAttempts)) : 1;
  n.range = medium + (n.range - medium) * (n.range < medium ? inwards : far_inwards);
  // A camera's own border lies farther out than where the board is wholly seen.
  const double wider = wholly ? 1 : 2;
  n.azimuth = inwards * spread(1, -wider * o.max_azimuth_rad, wider * o.max_azimuth_rad);
  n.elevation = inwards * spread(2, wider * o.min_elevation_rad, wider * o.max_elevation_rad) +
                (1 - inwards) * MiddleElevation(options, n.range);
  n.tilt_axis = spread(3, 0, 2 * M_PI);
  n.tilt = spread(4, o.min_tilt, 0.98) * o.max_tilt_rad;
  n.roll = spread(5, -0.98, 0.98) * o.max_roll_rad;
  return n;
}

}  // namespace

std::string WhyNotSeen(const Options& options, const World& empty, const Scanner& scanner,
                       const std::vector<CameraRenderer>& cameras,
                       const Rigid3& lidar_from_target) {
  const double asked = options.pose.outside_image;
  const bool wholly = asked == 0;
  if (!wholly && std::abs(ShareOutside(options.board, cameras, lidar_from_target) - asked) > 0.05) {
    return "not outside the image by the share that is asked for";
  }
  if (wholly && !InField(options, lidar_from_target.translation))
    return "outside the LIDAR's field";
  const std::vector<Rigid3> further = FurtherPoses(options);
  for (const Eigen::Vector3d& place : Places(options.board)) {
    const Eigen::Vector3d point = lidar_from_target * place;
    if (wholly && options.pose.whole_in_lidar && !InField(options, point)) {
      return "outside the LIDAR's field";
    }
    for (const CameraRenderer& camera : cameras) {
      if (wholly && !InImage(camera, options.pose.image_margin, point)) {
        return "outside the image of " + camera.options().name;
      }
    }
    if (point.z() < options.world.ground_z_m + options.pose.clearance_m) return "in the ground";
    if (Crowded(empty, point, options.pose.clearance_m)) return "too close to an object";
    const double azimuth = std::atan2(point.y(), point.x());
    const Eigen::Vector3d sensor =
        options.turned() ? scanner.Centre(azimuth) : Eigen::Vector3d::Zero();
    if (Hidden(empty, sensor, point)) return "hidden from the LIDAR";
    std::string why_not = WhyNotSeenByFurther(options, empty, further, point);
    if (!why_not.empty()) return why_not;
    for (const CameraRenderer& camera : cameras) {
      if (Hidden(empty, camera.CentreInLidar(), point)) {
        return "hidden from " + camera.options().name;
      }
    }
  }
  return "";
}

Rigid3 BoardPose(const Options& options, const World& empty, const Scanner& scanner,
                 const std::vector<CameraRenderer>& cameras, int index) {
  std::string why;
  for (int attempt = 0; attempt < 2 * kAttempts; ++attempt) {
    Rigid3 pose = MakePose(Draw(options, index, attempt));
    why = WhyNotSeen(options, empty, scanner, cameras, pose);
    if (why.empty()) return pose;
  }
  throw InputError("simulator: no place for the board in view " + std::to_string(index) +
                   " (the last of " + std::to_string(2 * kAttempts) + " tried is " + why +
                   "); give pose.* more room or a smaller board");
}

}  // namespace rgbdt::simulate
