#include "calib/model/range_errors.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {
namespace {

bool Same(const Estimate& a, const Estimate& b) { return a.value == b.value && a.sigma == b.sigma; }

}  // namespace

bool RangeErrors::operator==(const RangeErrors& other) const {
  const auto same_ring = [](const OfRing& a, const OfRing& b) {
    return a.ring == b.ring && Same(a.offset_m, b.offset_m);
  };
  const auto same_intensity = [](const OfIntensity& a, const OfIntensity& b) {
    return a.log2_intensity == b.log2_intensity && Same(a.offset_m, b.offset_m);
  };
  return Same(offset_m, other.offset_m) && Same(beams_meet_m, other.beams_meet_m) &&
         std::equal(rings.begin(), rings.end(), other.rings.begin(), other.rings.end(),
                    same_ring) &&
         std::equal(intensities.begin(), intensities.end(), other.intensities.begin(),
                    other.intensities.end(), same_intensity);
}

bool NamesLasers(const Cloud& cloud) {
  if (cloud.ring.size() != cloud.size()) return false;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.ring[i] >= kMostLasers && cloud.IsHit(i)) return false;
  }
  return true;
}

double Log2Intensity(double intensity) {
  if (!(intensity > 0)) return kLeastLog2Intensity;
  return std::clamp(std::log2(intensity), kLeastLog2Intensity, 0.0);
}

OctavePlace PlaceOf(double value, double first, std::size_t count) {
  if (count < 2) return {};
  const double at = std::clamp(value - first, 0.0, static_cast<double>(count - 1));
  const std::size_t lower = std::min(static_cast<std::size_t>(at), count - 2);
  return {lower, at - static_cast<double>(lower)};
}

double RangeOffset(const RangeErrors& errors, const Cloud& cloud, std::size_t i) {
  double offset = errors.offset_m.value;
  if (!errors.rings.empty() && cloud.ring.size() == cloud.size()) {
    const auto ring =
        std::lower_bound(errors.rings.begin(), errors.rings.end(), static_cast<int>(cloud.ring[i]),
                         [](const RangeErrors::OfRing& r, int number) { return r.ring < number; });
    if (ring != errors.rings.end() && ring->ring == cloud.ring[i]) offset += ring->offset_m.value;
  }
  if (!errors.intensities.empty() && cloud.intensity.size() == cloud.size()) {
    const OctavePlace place =
        PlaceOf(Log2Intensity(cloud.intensity[i]), errors.intensities.front().log2_intensity,
                errors.intensities.size());
    const double at_lower = errors.intensities[place.lower].offset_m.value;
    offset += at_lower;
    if (place.share > 0) {
      offset += place.share * (errors.intensities[place.lower + 1].offset_m.value - at_lower);
    }
  }
  return offset;
}

Cloud Corrected(Cloud cloud, const RangeErrors& errors) {
  const auto beams = static_cast<std::size_t>(std::max(1, cloud.beams));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    const Eigen::Vector3d origin = cloud.origins.empty()
                                       ? Eigen::Vector3d::Zero()
                                       : Eigen::Vector3d(cloud.origins[i / beams].cast<double>());
    const Eigen::Vector3d beam = cloud.points[i].cast<double>() - origin;
    const double range = beam.norm();
    const double flat = beam.head<2>().norm();
    if (!(range > 0)) continue;
    Eigen::Vector3d point = origin + beam * (1 + RangeOffset(errors, cloud, i) / range);
    if (flat > 0) point.z() -= errors.beams_meet_m.value * beam.z() / flat;
    cloud.points[i] = point.cast<float>();
  }
  return cloud;
}

}  // namespace rgbdt
