#pragma once

#include <cstdint>
#include <vector>

#include "calib/model/cloud.h"
#include "services/drivers/hesai/hesai_packets.h"

namespace rgbdt {

/// A Hesai's packets -> revolutions, organised ring x azimuth: line 0 is the lowest ring, beam 0
/// points backwards, the next ones as they were fired, clockwise from above. LIDAR frame: x forward
/// at azimuth 0, y left, z up (the manuals have y forward and x right). A beam that returned
/// nothing is NaN and keeps its direction. Rings whose channels look aside are shifted by whole
/// columns. Of a beam that was not fired in a column (high resolution, sensors whose channels take
/// turns) not even the direction is known. Of two returns of a beam the one of the higher
/// reflectivity counts. Columns of lost packets are left out: their neighbours stand side by side,
/// and how many are missing is counted. A revolution in which half a turn or more is missing, or
/// whose clock jumps, is left out.
///
/// Times: the packets' own date and time; where the sensor's clock was never set, their arrival.
class HesaiSweeps {
 public:
  explicit HesaiSweeps(hesai::Angles angles);

  /// The revolutions that a packet, which arrived at `arrival` [us, UTC], completed. The first, cut
  /// off one never comes. Throws InputError for one of a sensor of another number of channels.
  std::vector<Cloud> Add(const hesai::Packet& packet, Utime arrival);

  /// Name of the revolution that has begun; 0: none.
  Utime begun() const;
  std::size_t channels() const { return angles_.elevation_rad.size(); }
  /// Columns that never came, by the azimuths of those about them; but for `left_out`.
  std::int64_t lost_columns() const { return lost_columns_; }
  std::int64_t left_out() const { return left_out_; }  ///< revolutions

 private:
  struct Fired {
    double azimuth_rad = 0;
    double utime = 0;
    std::vector<hesai::Return> returns;
  };
  void CountLost(const hesai::Packet& packet, double utime);
  void Leave();
  Cloud Revolution() const;

  hesai::Angles angles_;
  std::vector<std::size_t> ring_;  // by channel
  std::vector<Fired> columns_;
  double last_from_seam_ = -1;  // of the column before; -1: there is none
  double last_utime_ = 0;       // of its packet
  std::int64_t lost_columns_ = 0, left_out_ = 0;
  bool whole_ = false;  // `columns_` begin at the seam
};

}  // namespace rgbdt
