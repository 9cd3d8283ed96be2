#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/import/topics.h"

namespace rgbdt {

/// A view to be: the reference's cloud, and each camera's image and each further LIDAR's cloud that
/// is nearest to it in time.
struct Moment {
  Stamped cloud;
  std::vector<std::optional<Stamped>> images;  ///< as TopicChoice::cameras; none within reach
  std::vector<std::optional<Stamped>> further_clouds{};  ///< as TopicChoice::further_lidars
};

/// The first time that any of the chosen topics measured: what seconds are counted from.
Utime StartOf(const TopicChoice& choice);

/// Of each of these times the nearest cloud, once, with each camera's nearest image and each
/// further LIDAR's nearest cloud within `max_apart_s` of it; in order. Times from which the nearest
/// cloud is farther than clouds usually are from each other, and clouds without any image, are told
/// in `left_over`. Throws InputError, with how far apart they are, where none is left, or none has
/// a cloud of one of the LIDARs.
std::vector<Moment> PairAt(const TopicChoice& choice, const std::vector<Utime>& times,
                           double max_apart_s, std::vector<std::string>* left_over);

/// Every so many seconds, from the first cloud on.
std::vector<Utime> EverySeconds(const TopicChoice& choice, double every_s);

}  // namespace rgbdt
