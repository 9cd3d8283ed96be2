#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "services/drivers/clock_fit.h"
#include "services/drivers/ouster/ouster_packets.h"

namespace rgbdt {

/// An Ouster's packets -> turns, organised ring x azimuth: line 0 is the lowest ring, beam 0 points
/// backwards, the next ones clockwise from above; rows are moved by whole columns (pixel_shift), so
/// that neighbours in the grid are neighbours in angle. The sensor's frame: x forward, away from
/// the connector, y left, z up. A beam that returned nothing is NaN and keeps its direction; of
/// columns that never came not even that is known, but their places stay. Of two returns of a
/// beam the first one, which the sensor calls the stronger, counts, or else the second.
///
/// Times: a clock that counts from 1970 (PTP, GPS) is taken as it is, less the whole seconds that
/// PTP is ahead of UTC (PtpToUtc); another is laid on the host's by when its packets arrive
/// (ClockFit), each turn as it is known at its begin: within a turn times are the sensor's.
class OusterSweeps {
 public:
  explicit OusterSweeps(ouster::Metadata metadata);

  /// The turn that a packet, which arrived at `arrival` [us, UTC], ended. The first, cut off one
  /// never comes.
  std::optional<Cloud> Add(const ouster::Packet& packet, Utime arrival);
  /// At a recording's end: the last turn, where all of it came.
  std::optional<Cloud> Finish();

  /// Name of the turn that has begun; 0: none.
  Utime begun() const;
  const ouster::Metadata& metadata() const { return metadata_; }
  /// Of the turns that were given out: columns that never came, or that the sensor calls invalid.
  std::int64_t lost_columns() const { return lost_columns_; }

 private:
  bool IsLate(int frame) const;
  void FollowClock(const ouster::Packet& packet, Utime arrival);
  Utime TimeOf(std::int64_t time_ns) const;
  void Put(const ouster::Column& column, Utime utime);
  std::optional<Cloud> Take();
  void Begin(int frame);

  ouster::Metadata metadata_;
  std::vector<ouster::Beam> beams_;  // row by row
  std::vector<Eigen::Vector3f> origins_;
  ClockFit fit_{ClockFitOptions{1e-3}};
  ClockFit fit_of_turn_{ClockFitOptions{1e-3}};
  bool turn_has_fit_ = false;
  Utime ahead_ = 0;  // whole seconds that the sensor's clock is ahead of UTC
  std::optional<int> frame_;
  bool first_ = true;         // the turn under way is the first
  std::vector<bool> came_;    // by column
  std::vector<Utime> times_;  // by column
  Cloud cloud_;
  std::int64_t lost_columns_ = 0;
};

}  // namespace rgbdt
