#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calib/model/rgbdt_cloud.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// The fused cloud for browsers: chunks as they come, which the whole sweep takes the place of; and
/// the points of the newest whole sweep, LIDAR frame [m].
class FusedPosts {
 public:
  using Points = std::shared_ptr<const std::vector<Eigen::Vector3f>>;
  static constexpr std::size_t kMaxPoints = 2'000'000;  ///< that are kept of a sweep

  /// Posts it. Whether it was the last part of a whole sweep.
  bool Add(const RgbdtCloud& cloud, Outbox* outbox);

  /// Null: there is none yet.
  const Points& whole_sweep() const { return whole_sweep_; }

 private:
  Utime sweep_utime_ = 0;  // of the newest whole sweep
  int part_ = 0;
  std::vector<Eigen::Vector3f> points_;  // as far as it has come
  Points whole_sweep_;
};

}  // namespace rgbdt::viewer
