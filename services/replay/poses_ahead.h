#pragma once

#include <algorithm>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/session.h"

namespace rgbdt {

/// When the newest of its points was taken.
inline Utime NewestOf(const Cloud& cloud) {
  return cloud.utime.empty() ? cloud.sweep_utime
                             : *std::max_element(cloud.utime.begin(), cloud.utime.end());
}

/// Hands over poses that were found before, in time for the points that need them: up to the first
/// after them. Two at least, as a single one is that of a rig that stands.
class PosesAhead {
 public:
  explicit PosesAhead(const std::vector<StampedPose>& way) : way_(way) {}

  template <typename Take>
  void Until(Utime utime, const Take& take) {
    while (next_ < way_.size() && (next_ < 2 || way_[next_ - 1].utime < utime)) {
      take(way_[next_++]);
    }
  }

 private:
  const std::vector<StampedPose>& way_;
  std::size_t next_ = 0;
};

}  // namespace rgbdt
