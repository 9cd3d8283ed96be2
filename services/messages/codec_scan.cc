#include <cmath>
#include <limits>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {

line_scan_t ToWire(const LineScan& line) {
  CheckLength("intensity", line.intensity.size(), line.range.size());
  line_scan_t wire;
  wire.utime = line.utime;
  wire.seq = line.seq;
  wire.beam_period_s = line.beam_period_s;
  wire.first_angle_rad = line.first_angle_rad;
  wire.angle_step_rad = line.angle_step_rad;
  wire.num_beams = CountOf(line.range.size(), "num_beams");
  wire.range_m = line.range;
  wire.intensity = line.intensity;
  wire.intensity.resize(line.range.size(), std::numeric_limits<float>::quiet_NaN());
  return wire;
}

void Check(const line_scan_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckNotNegative("beam_period_s", wire.beam_period_s);
  CheckFinite("first_angle_rad", wire.first_angle_rad);
  CheckFinite("angle_step_rad", wire.angle_step_rad);
  for (std::size_t i = 0; i < wire.range_m.size(); ++i) {
    const float range = wire.range_m[i];
    if (!std::isnan(range) && !(range > 0 && range <= kMaxMetres)) {
      Fail(At("range_m", i), range, "0 to 1e6 m, or NaN where nothing returned");
    }
    const float intensity = wire.intensity[i];
    if (!std::isnan(intensity) && !(intensity >= 0 && intensity <= 1)) {
      Fail(At("intensity", i), intensity, "0 to 1, or NaN: unknown");
    }
  }
}

LineScan FromWire(const line_scan_t& wire) {
  LineScan line;
  line.utime = wire.utime;
  line.seq = wire.seq;
  line.beam_period_s = wire.beam_period_s;
  line.first_angle_rad = wire.first_angle_rad;
  line.angle_step_rad = wire.angle_step_rad;
  line.range = wire.range_m;
  line.intensity = wire.intensity;
  return line;
}

encoder_t ToWire(const EncoderReading& reading) {
  encoder_t wire;
  wire.utime = reading.utime;
  wire.seq = reading.seq;
  wire.ticks = reading.ticks;
  wire.sweep_utime = reading.sweep_utime;
  return wire;
}

void Check(const encoder_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckRange("ticks", wire.ticks, -kMaxInteger, kMaxInteger);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
}

EncoderReading FromWire(const encoder_t& wire) {
  EncoderReading reading;
  reading.utime = wire.utime;
  reading.seq = wire.seq;
  reading.ticks = wire.ticks;
  reading.sweep_utime = wire.sweep_utime;
  return reading;
}

}  // namespace rgbdt
