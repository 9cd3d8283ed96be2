#include "tests/bench/analytic_cloud.h"

#include <algorithm>
#include <cmath>

#include "calib/simulate/internal/noise.h"
#include "calib/simulate/lidar_options.h"

namespace rgbdt::bench {
namespace {

using simulate::kDegree;
using simulate::Noise;

constexpr double kWide = 60 * kDegree;
constexpr double kHigh = 80 * kDegree;
constexpr double kSigma = 0.01;
const Eigen::Vector3d kRoomLow(-4, -5, -1.2), kRoomHigh(9, 5, 3);  // LIDAR frame

// Range to the room's walls from within.
double ToWalls(const Eigen::Vector3d& direction) {
  double range = 1e9;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) < 1e-12) continue;
    range = std::min(range, (direction[k] > 0 ? kRoomHigh : kRoomLow)[k] / direction[k]);
  }
  return range;
}

// Ranges to the board's front or to what is behind it.
class Board {
 public:
  Board(const Target& target, const Rigid3& lidar_from_target)
      : half_(target.width_m / 2, target.height_m / 2),
        to_target_(lidar_from_target.rotation.toRotationMatrix().transpose()),
        origin_(-(to_target_ * lidar_from_target.translation)) {}

  double Range(const Eigen::Vector3d& direction) const {
    const double walls = ToWalls(direction);
    const Eigen::Vector3d d = to_target_ * direction;
    const double range = -origin_.z() / d.z();
    if (!(range > 0 && range < walls)) return walls;
    const Eigen::Vector2d at = (origin_ + range * d).head<2>();
    return (at.cwiseAbs() - half_).maxCoeff() <= 0 ? range : walls;
  }

 private:
  Eigen::Vector2d half_;
  Eigen::Matrix3d to_target_;
  Eigen::Vector3d origin_;
};

}  // namespace

Cloud AnalyticCloud(const Target& target, const Rigid3& lidar_from_target, int points,
                    std::uint64_t seed) {
  const Board board(target, lidar_from_target);
  const Noise noise(seed, 0, "analytic cloud");
  Cloud cloud;
  cloud.lines = static_cast<int>(std::lround(std::sqrt(points * kWide / kHigh)));
  cloud.beams = points / cloud.lines;
  const auto size = static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.reserve(size);
  cloud.directions.reserve(size);
  for (int line = 0; line < cloud.lines; ++line) {
    const double azimuth = kWide * ((line + 0.5) / cloud.lines - 0.5);
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const double elevation = kHigh * ((beam + 0.5) / cloud.beams - 0.5);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double range = board.Range(direction) + kSigma * noise.Normal(cloud.points.size());
      cloud.directions.emplace_back(direction.cast<float>());
      cloud.points.emplace_back((range * direction).cast<float>());
    }
  }
  return cloud;
}

Rigid3 DrawBoard(std::uint64_t seed, int index) {
  const Noise noise(seed, index, "bench board");
  const auto draw = [&](std::uint64_t k, double most) { return noise.Uniform(k, -most, most); };
  Eigen::Matrix3d facing;  // target x right, y down, z away, seen along the LIDAR's x
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Rigid3 sight = RotationAbout({0, 0, 1}, draw(0, 14 * kDegree)) *
                       RotationAbout({0, 1, 0}, draw(1, 8 * kDegree));
  Rigid3 board = sight * Rigid3{Eigen::Quaterniond(facing), {0, 0, 0}} *
                 RotationAbout({1, 0, 0}, draw(2, 30 * kDegree)) *
                 RotationAbout({0, 1, 0}, draw(3, 30 * kDegree)) *
                 RotationAbout({0, 0, 1}, draw(4, 40 * kDegree));
  board.translation = sight * Eigen::Vector3d(noise.Uniform(5, 2.2, 5), 0, 0);
  return board;
}

}  // namespace rgbdt::bench
