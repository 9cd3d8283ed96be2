#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/time.h"

namespace rgbdt::spinning {

/// Where each channel looks, of one device.
struct Angles {
  std::vector<double> elevation_rad;  ///< by channel
  std::vector<double> azimuth_rad;    ///< by channel: to be added to the head's, clockwise
};

struct Return {
  double range_m = 0;  ///< 0: nothing returned
  std::uint8_t reflectivity = 0;
  float after_us = 0;    ///< when it was fired, from its column's time; NaN: it was not
  float turned_rad = 0;  ///< how far the head turned since its column's azimuth
};

/// One firing of all channels.
struct Column {
  double azimuth_rad = 0;       ///< of the head, clockwise from above, 0 at the sensor's front
  double time_us = 0;           ///< from the packet's stamp; a return's time comes on top
  std::vector<Return> returns;  ///< by channel
  std::vector<Return> second_returns;  ///< of two returns; else empty
};

struct Packet {
  std::optional<Utime> utime;  ///< the packet's stamp; absent: its clock was never set
  std::vector<Column> columns;
  double column_us = 0;  ///< from column to column
};

/// Where ranges count from: a lens that turns with the head.
struct Lens {
  double outward_m = 0, up_m = 0;  ///< from the turning axis, from the sensor's origin
};

}  // namespace rgbdt::spinning

namespace rgbdt {

/// A spinning LIDAR's packets -> revolutions, organised ring x azimuth: line 0 is the lowest ring,
/// beam 0 points backwards, the next ones as they were fired, clockwise from above. LIDAR frame: x
/// forward at azimuth 0, y left, z up (the manuals have y forward and x right). A beam that
/// returned nothing is NaN and keeps its direction. Rings whose channels look aside are shifted by
/// whole columns. Of a beam that was not fired in a column (high resolution, sensors whose channels
/// take turns) not even the direction is known. Of two returns of a beam the one of the higher
/// reflectivity counts. Columns of lost packets are left out: their neighbours stand side by side,
/// and how many are missing is counted. A revolution in which half a turn or more is missing, or
/// whose clock jumps, is left out.
///
/// Times: the packets' own date and time; where the sensor's clock was never set, their arrival.
class SpinningSweeps {
 public:
  explicit SpinningSweeps(spinning::Angles angles, spinning::Lens lens = {});

  /// The revolutions that a packet, which arrived at `arrival` [us, UTC], completed. The first, cut
  /// off one never comes. Throws InputError for one of a sensor of another number of channels.
  std::vector<Cloud> Add(const spinning::Packet& packet, Utime arrival);

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
    std::vector<spinning::Return> returns;
  };
  void CountLost(const spinning::Packet& packet, double utime);
  void Leave();
  Cloud Revolution() const;

  spinning::Angles angles_;
  spinning::Lens lens_;
  std::vector<std::size_t> ring_;  // by channel
  std::vector<Fired> columns_;
  double last_from_seam_ = -1;   // of the column before; -1: there is none
  double last_utime_ = 0;        // of its packet
  double last_step_ = 2 * M_PI;  // between packets of one column, of which none was lost
  std::int64_t lost_columns_ = 0, left_out_ = 0;
  bool whole_ = false;  // `columns_` begin at the seam
};

}  // namespace rgbdt
