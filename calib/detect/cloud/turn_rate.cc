#include "calib/detect/cloud/turn_rate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kLeastHorizontal = 0.3;  // of a unit direction that has an azimuth
constexpr double kAbout = 0.1;            // [rad] beside what is scanned: the lines that tell
constexpr std::size_t kBeamStep = 8;

std::optional<double> Azimuth(const Cloud& cloud, std::size_t i) {
  const Eigen::Vector3d direction = DirectionOf(cloud, i).cast<double>();
  if (!(direction.head<2>().norm() > kLeastHorizontal)) return std::nullopt;
  return std::atan2(direction.y(), direction.x());
}

double Wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

}  // namespace

double TurnRate(const Cloud& cloud, const Eigen::Vector3d& towards) {
  if (!cloud.organised || cloud.lines < 2 || cloud.utime.size() != cloud.size()) return 0;
  const double centre = std::atan2(towards.y(), towards.x());
  const auto beams = static_cast<std::size_t>(cloud.beams);
  std::vector<double> rates;
  for (std::size_t i = 0; i + beams < cloud.size(); i += kBeamStep) {
    const auto here = Azimuth(cloud, i);
    if (!here || std::abs(Wrapped(*here - centre)) > kAbout) continue;
    const auto next = Azimuth(cloud, i + beams);
    const double seconds = ToSeconds(cloud.utime[i + beams] - cloud.utime[i]);
    if (next && seconds > 0) rates.push_back(Wrapped(*next - *here) / seconds);
  }
  return rates.size() < 2 ? 0 : Median(std::move(rates));
}

}  // namespace rgbdt
