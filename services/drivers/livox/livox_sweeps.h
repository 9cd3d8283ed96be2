#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "services/drivers/clock_fit.h"
#include "services/drivers/livox/livox_packets.h"

namespace rgbdt {

/// A Livox's packets -> clouds of a second each (kLivoxCloudUs), one after the other: hits in the
/// order in which they were measured, without rings (Cloud::organised is false), as the sensor's
/// own frame has them, x forward, y left, z up. A cloud of which more than a tenth never came is
/// left out, and so are a million points that came while the sensor's clock stood still.
///
/// Times: the packets' own where the sensor follows PTP or GPS; otherwise mapped to the host's
/// clock from when they arrive (ClockFit), each cloud as the clock is known at its begin: within a
/// cloud times are the sensor's.
class LivoxSweeps {
 public:
  /// The cloud that a packet, which arrived at `arrival` [us, UTC], completed. Packets that come
  /// late are passed over.
  std::optional<Cloud> Add(const livox::Packet& packet, Utime arrival);
  /// The cloud under way at the end, where it is a whole second's.
  std::optional<Cloud> Finish();

  /// Name of the cloud that has begun; 0: none.
  Utime begun() const { return any_ ? begun_ : 0; }
  std::int64_t lost_ms() const { return lost_us_ / 1000; }  ///< stretches of which nothing came
  std::int64_t dropped() const { return dropped_; }         ///< beams whose tag says noise
  std::int64_t left_out() const { return left_out_; }       ///< clouds

 private:
  void FollowClock(const livox::Packet& packet, Utime arrival);
  Utime TimeOf(const livox::Packet& packet, Utime arrival) const;
  std::optional<Cloud> Take();

  ClockFit fit_{ClockFitOptions{1e-3}};
  ClockFit fit_of_cloud_{ClockFitOptions{1e-3}};
  Cloud cloud_;
  Utime begun_ = 0, next_ = 0;  // of the cloud; when the next packet is due
  Utime cloud_lost_us_ = 0;
  std::int64_t lost_us_ = 0, dropped_ = 0, left_out_ = 0;
  bool any_ = false;
};

}  // namespace rgbdt
