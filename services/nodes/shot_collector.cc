#include "services/nodes/shot_collector.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/monitor/still_cloud.h"

namespace rgbdt {
namespace {

// When the LIDAR looked where the camera looks: the middle one of the times of points that lie in
// the image; of a sweep without times, or of which none does, its start.
Utime WhenSeen(const Cloud& sweep, const CameraSpec& spec, const Rigid3& camera_from_lidar) {
  constexpr std::size_t kEvery = 7;  // no number of beams is a multiple of it
  if (sweep.utime.empty()) return sweep.sweep_utime;
  const Camera camera(spec);
  std::vector<Utime> times;
  for (std::size_t i = 0; i < sweep.size(); i += kEvery) {
    if (!sweep.IsHit(i)) continue;
    const auto pixel = camera.Project(camera_from_lidar * sweep.points[i].cast<double>().eval());
    if (pixel && camera.Contains(*pixel)) times.push_back(sweep.utime[i]);
  }
  if (times.empty()) return sweep.sweep_utime;
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

// How long before the sweep began or after its last point; 0: while it was swept.
Utime FromSweep(const Cloud& sweep, Utime utime) {
  const Utime first = sweep.sweep_utime;
  const Utime last =
      sweep.utime.empty() ? first : *std::max_element(sweep.utime.begin(), sweep.utime.end());
  return std::max<Utime>({0, first - utime, utime - last});
}

Utime Apart(Utime a, Utime b) { return a < b ? b - a : a - b; }

}  // namespace

void ShotCollector::Add(const Image& image, const std::optional<CameraTiming>& timing) {
  if (image.shutter_correcting) return;
  const Utime taken = image.utime + (timing ? timing->Offset() : 0);
  std::deque<TimedImage>& images = images_[image.camera];
  if (!images.empty() && taken < images.back().taken - kClockReset) images.clear();
  const auto later =
      std::upper_bound(images.begin(), images.end(), taken,
                       [](Utime utime, const TimedImage& other) { return utime < other.taken; });
  images.insert(later, {image, taken});
  if (images.size() <= kKept) return;
  // Of those from while a long sweep goes on, every second one of the older half.
  for (std::size_t i = 1; i < images.size() / 2; ++i) {
    images.erase(images.begin() + static_cast<std::ptrdiff_t>(i));
  }
  const Utime newest = images.back().taken;
  while (images.front().taken < newest - PoseTrack::kKept) images.pop_front();
}

bool ShotCollector::Add(CloudChunk chunk) {
  const Utime sweep = chunk.cloud.sweep_utime;
  const bool before = sweeps_.Ended(sweep);
  sweeps_.Add(std::move(chunk));
  return !before && sweeps_.Ended(sweep);
}

std::optional<TakenShot> ShotCollector::ShotOf(const Cloud& sweep, const CameraSpec& camera,
                                               const Rigid3& camera_from_lidar) const {
  const auto found = images_.find(camera.name);
  if (found == images_.end()) return std::nullopt;
  const Utime seen = WhenSeen(sweep, camera, camera_from_lidar);
  const auto nearest = std::min_element(found->second.begin(), found->second.end(),
                                        [&](const TimedImage& a, const TimedImage& b) {
                                          return Apart(a.taken, seen) < Apart(b.taken, seen);
                                        });
  if (nearest == found->second.end() || FromSweep(sweep, nearest->taken) > kFarthest) {
    return std::nullopt;
  }
  std::optional<Cloud> still = AsSeenAt(sweep, poses_, nearest->taken);
  if (!still) return std::nullopt;
  return TakenShot{std::move(*still), nearest->image, nearest->taken, poses_.At(nearest->taken)};
}

}  // namespace rgbdt
