#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "services/drivers/clock_fit.h"
#include "services/drivers/velodyne/velodyne_packets.h"

namespace rgbdt {

/// A spinning LIDAR's packets -> revolutions, organised ring x azimuth: line 0 is the lowest ring,
/// beam 0 points backwards (there lies the seam, away from what cameras see), the next ones as they
/// were fired, clockwise from above. LIDAR frame: x is forward at the head's azimuth 0, y left, z
/// up (the manuals have y forward and x right). A beam that returned nothing is NaN and keeps its
/// direction; of a lost packet's beams not even that is known, but their places stay. Each point
/// has its own time and the head's azimuth of that time.
///
/// Rings whose lasers look aside (VLP-32C) are shifted by whole columns, so that neighbours in the
/// grid are neighbours in angle; the few that this takes over the seam are of the revolution's
/// other end.
///
/// Times: the packets' own, us since the hour, mapped to the host's clock from when they arrive
/// (ClockFit, the packet's own duration known), each revolution as the clock is known at its begin:
/// within a revolution times are the sensor's. Where the sensor's clock stands still, the arrival
/// less that duration.
class VelodyneSweeps {
 public:
  explicit VelodyneSweeps(VelodyneDevice::Model model);

  /// What a packet, which arrived at `arrival` [us, UTC], completed: at most one revolution unless
  /// it turns faster than it sends. The first, cut off one never comes.
  std::vector<Cloud> Add(const velodyne::Packet& packet, Utime arrival);

  /// Packets that were to come between the ones that came. Those that come twice or late are passed
  /// over.
  std::int64_t lost_packets() const { return lost_packets_; }
  /// How often somebody set the sensor's clock or the host's.
  std::int64_t clock_steps() const { return clock_steps_; }
  /// Name of the revolution that has begun; 0: none.
  Utime begun() const { return begun_; }

 private:
  struct FiredColumn {
    double azimuth_deg = 0, step_deg = 0;
    double stamp_us = 0;                    // by the sensor's clock
    Utime utime = 0;                        // of those of a revolution
    std::vector<velodyne::Return> returns;  // empty: lost
  };

  bool IsOldNews(std::int64_t stamp);
  void FollowClock(const velodyne::Packet& packet, std::int64_t stamp, Utime arrival);
  Utime TimeOf(double stamp_us) const;
  void FillGap(const velodyne::Packet& packet, std::int64_t stamp, std::vector<Cloud>* done);
  void Push(FiredColumn column, std::vector<Cloud>* done);
  Cloud Revolution() const;
  void FillBeam(const FiredColumn& column, std::size_t laser, std::size_t i, Cloud* cloud) const;
  double PacketDuration_us(const velodyne::Packet& packet) const;

  const velodyne::Sensor& sensor_;
  std::vector<double> cos_elevation_, sin_elevation_, laser_us_;
  CounterUnwrapper counter_{velodyne::kHourUs};
  ClockFit fit_, fit_of_turn_;
  std::optional<Utime> standing_;  // the clock stands still: the host's time less the sensor's
  std::optional<std::int64_t> last_stamp_;
  std::optional<FiredColumn> last_column_;
  std::vector<FiredColumn> columns_;
  bool whole_ = false;  // `columns_` begin at the seam
  int same_stamps_ = 0;
  Utime begun_ = 0;
  std::int64_t lost_packets_ = 0, clock_steps_ = 0;
};

}  // namespace rgbdt
