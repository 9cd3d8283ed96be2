#include "calib/fuse/internal/motion.h"

#include <algorithm>

namespace rgbdt {
namespace {

constexpr Utime kStep = 5'000;  // between two places that are worked out; straight in between
constexpr Utime kLongest = 60 * kMicrosecondsPerSecond;

struct Place {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
};

}  // namespace

bool PlaceInSweep(const PoseTrack& poses, const Rigid3& map_from_sweep,
                  const std::vector<Utime>& utime, std::vector<Eigen::Vector3f>* points) {
  if (points->empty()) return true;
  const auto [first, last] = std::minmax_element(utime.begin(), utime.end());
  const Utime from = *first;
  if (*last - from > kLongest) return false;
  const Rigid3 sweep_from_map = map_from_sweep.Inverse();
  std::vector<Place> places;
  for (Utime t = from; t < *last + kStep; t += kStep) {
    // The last one may lie after what is asked for; what is not known there is not needed.
    const auto map_from_lidar = poses.At(std::min(t, *last));
    if (!map_from_lidar) return false;
    const Rigid3 place = sweep_from_map * *map_from_lidar;
    places.push_back(
        {place.rotation.toRotationMatrix().cast<float>(), place.translation.cast<float>()});
  }
  for (std::size_t i = 0; i < points->size(); ++i) {
    const Utime since = utime[i] - from;
    const auto k = static_cast<std::size_t>(since / kStep);
    const Place& a = places[k];
    const Place& b = places[std::min(k + 1, places.size() - 1)];
    // Between the two, along time; the last step may be shorter.
    const Utime begin = static_cast<Utime>(k) * kStep;
    const Utime length = std::min(kStep, *last - from - begin);
    const float share =
        length > 0 ? static_cast<float>(since - begin) / static_cast<float>(length) : 0.0F;
    Eigen::Vector3f& p = (*points)[i];
    const Eigen::Vector3f at_a = a.rotation * p + a.translation;
    const Eigen::Vector3f at_b = b.rotation * p + b.translation;
    p = at_a + share * (at_b - at_a);
  }
  return true;
}

}  // namespace rgbdt
