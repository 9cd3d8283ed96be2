#include "calib/detect/cloud/cloud_sanity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

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

}  // namespace

std::string WhyCloudIsOff(const Cloud& cloud) {
  std::string why = WhyUnitIsOff(cloud);
  return why.empty() ? WhyAxesAreOff(cloud) : why;
}

}  // namespace rgbdt
