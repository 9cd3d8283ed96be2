#include "services/import/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/errors.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// `stamped` is sorted and not empty.
const Stamped& Nearest(const std::vector<Stamped>& stamped, Utime utime) {
  const auto after =
      std::lower_bound(stamped.begin(), stamped.end(), utime,
                       [](const Stamped& one, Utime time) { return one.utime < time; });
  if (after == stamped.begin()) return *after;
  const auto before = after - 1;
  if (after == stamped.end()) return *before;
  return utime - before->utime <= after->utime - utime ? *before : *after;
}

std::optional<Stamped> NearestWithin(const std::vector<Stamped>& stamped, Utime utime,
                                     double max_apart_s) {
  const Stamped& nearest = Nearest(stamped, utime);
  if (std::abs(ToSeconds(nearest.utime - utime)) > max_apart_s) return std::nullopt;
  return nearest;
}

// From a cloud to the next, median; of a single one as far as an image may be.
double SpacingOf(const std::vector<Stamped>& clouds, double otherwise_s) {
  std::vector<double> apart;
  for (std::size_t i = 1; i < clouds.size(); ++i) {
    apart.push_back(ToSeconds(clouds[i].utime - clouds[i - 1].utime));
  }
  return apart.empty() ? otherwise_s : std::max(otherwise_s, Median(std::move(apart)));
}

// Each further LIDAR is in some view.
void RequireFurtherLidars(const TopicChoice& choice, const std::vector<Moment>& moments,
                          double max_apart_s) {
  for (std::size_t i = 0; i < choice.further_lidars.size(); ++i) {
    const TopicChoice::Lidar& lidar = choice.further_lidars[i];
    double nearest_s = std::numeric_limits<double>::infinity();
    for (const Moment& moment : moments) {
      const Utime nearest = Nearest(lidar.clouds->stamped, moment.cloud.utime).utime;
      nearest_s = std::min(nearest_s, std::abs(ToSeconds(nearest - moment.cloud.utime)));
    }
    if (nearest_s <= max_apart_s) continue;
    throw InputError("no view has a cloud of LIDAR " + lidar.name + " within " +
                     Fixed(max_apart_s, 3) + " s of its cloud of " + choice.lidar.name +
                     "; the nearest is " + Format("%.6g", nearest_s) +
                     " s away (--max-apart; do both sensors' headers tell the same clock?)");
  }
}

}  // namespace

Utime StartOf(const TopicChoice& choice) {
  Utime start = choice.lidar.clouds->stamped.front().utime;
  for (const TopicChoice::Camera& camera : choice.cameras) {
    start = std::min(start, camera.images->stamped.front().utime);
  }
  for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
    start = std::min(start, lidar.clouds->stamped.front().utime);
  }
  return start;
}

std::vector<Moment> PairAt(const TopicChoice& choice, const std::vector<Utime>& times,
                           double max_apart_s, std::vector<std::string>* left_over) {
  const Utime start = StartOf(choice);
  std::vector<Utime> sorted = times;
  std::sort(sorted.begin(), sorted.end());
  std::vector<Moment> moments;
  double nearest_s = std::numeric_limits<double>::infinity();
  const double spacing_s = SpacingOf(choice.lidar.clouds->stamped, max_apart_s);
  std::string alone, far;
  Utime last = std::numeric_limits<Utime>::min();
  for (const Utime time : sorted) {
    Moment moment;
    moment.cloud = Nearest(choice.lidar.clouds->stamped, time);
    if (std::abs(ToSeconds(moment.cloud.utime - time)) > spacing_s) {
      far += (far.empty() ? "" : ", ") + Fixed(ToSeconds(time - start), 2) + " s";
      continue;
    }
    if (moment.cloud.utime == last) continue;
    last = moment.cloud.utime;
    bool any = false;
    for (const TopicChoice::Camera& camera : choice.cameras) {
      const Stamped& image = Nearest(camera.images->stamped, moment.cloud.utime);
      const double apart_s = std::abs(ToSeconds(image.utime - moment.cloud.utime));
      nearest_s = std::min(nearest_s, apart_s);
      auto& of_camera = moment.images.emplace_back();
      if (apart_s > max_apart_s) continue;
      of_camera = image;
      any = true;
    }
    for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
      moment.further_clouds.push_back(
          NearestWithin(lidar.clouds->stamped, moment.cloud.utime, max_apart_s));
    }
    if (any) {
      moments.push_back(moment);
    } else {
      alone += (alone.empty() ? "" : ", ") + Fixed(ToSeconds(moment.cloud.utime - start), 2) + " s";
    }
  }
  if (!far.empty()) {
    far = "no cloud is within " + Fixed(spacing_s, 3) + " s of: " + far;
    if (moments.empty() && alone.empty()) throw InputError(far);
    left_over->push_back(far);
  }
  if (moments.empty() && !sorted.empty()) {
    throw InputError("no image is within " + Fixed(max_apart_s, 3) +
                     " s of a cloud; the nearest is " + Format("%.6g", nearest_s) +
                     " s away (--max-apart; do both sensors' headers tell the same clock?)");
  }
  if (!moments.empty()) RequireFurtherLidars(choice, moments, max_apart_s);
  if (!alone.empty()) left_over->push_back("clouds without an image: " + alone);
  return moments;
}

std::vector<Utime> EverySeconds(const TopicChoice& choice, double every_s) {
  std::vector<Utime> times;
  Utime next = std::numeric_limits<Utime>::min();
  for (const Stamped& cloud : choice.lidar.clouds->stamped) {
    if (cloud.utime < next) continue;
    times.push_back(cloud.utime);
    next = cloud.utime + FromSeconds(every_s);
  }
  return times;
}

}  // namespace rgbdt
