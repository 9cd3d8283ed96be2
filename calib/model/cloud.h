#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// One line of a 2D scanner: `range.size()` beams fired one after the other.
struct LineScan {
  Utime utime = 0;  ///< of the first beam
  std::int64_t seq = 0;
  double beam_period_s = 0;    ///< between two beams of the line
  double first_angle_rad = 0;  ///< of beam 0 in the scan plane, from the scanner's x towards its z
  double angle_step_rad = 0;   ///< from one beam to the next
  std::vector<float> range;    ///< [m]; NaN: nothing returned
  std::vector<float> intensity;  ///< 0 to 1, reflectivity-like; as long as `range`

  /// When a beam was fired; of the beam after the last, when the line ends.
  Utime FiredAt(std::size_t beam) const {
    return utime + FromSeconds(static_cast<double>(beam) * beam_period_s);
  }
};

/// One reading of the motor's encoder.
struct EncoderReading {
  Utime utime = 0;
  std::int64_t seq = 0;
  std::int64_t ticks = 0;
  Utime sweep_utime = 0;  ///< start of the sweep that this reading belongs to; 0: between sweeps
};

/// A cloud, organised as the sensor saw it: line x beam, index = line * beams + beam. A whole sweep
/// or a chunk of one. LIDAR frame, metres. What a sensor does not tell leaves its vector empty.
struct Cloud {
  Utime sweep_utime = 0;  ///< start of the sweep: its name
  int first_line = 0;     ///< where line 0 lies in the sweep
  int lines = 0;
  int beams = 0;  ///< per line; an unorganised cloud is one line
  bool organised = true;
  std::vector<Eigen::Vector3f> points;      ///< NaN where the beam returned nothing
  std::vector<Eigen::Vector3f> directions;  ///< unit, of each miss; of hits perhaps; empty: unknown
  std::vector<Eigen::Vector3f> origins;     ///< one a line: where its beams start; empty: zero
  std::vector<float> intensity;             ///< 0 to 1
  std::vector<Utime> utime;                 ///< of each point
  std::vector<std::uint16_t> ring;          ///< laser (spinning) or beam (turned scanner)

  std::size_t size() const { return points.size(); }
  bool IsHit(std::size_t i) const { return std::isfinite(points[i].x()); }
};

/// Unit direction of a beam, of a hit, too, where only its point tells it; NaN: unknown.
Eigen::Vector3f DirectionOf(const Cloud& cloud, std::size_t i);

/// How many lines of an organised sweep never came: of such a line not even directions are known.
int LostLines(const Cloud& cloud);

/// A chunk of a sweep as it travels on the bus. The last one has `sweep_end` and may be empty.
struct CloudChunk {
  std::int64_t seq = 0;
  Cloud cloud;
  bool sweep_end = false;
  int sweep_lines = 0;  ///< with sweep_end: lines that the sweep has
  int lines_lost = 0;   ///< with sweep_end: lines known to be missing (gaps, no encoder reading)
};

}  // namespace rgbdt
