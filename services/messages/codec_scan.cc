#include <cmath>
#include <limits>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, line_scan_t>& wire, StructOf<Copy, LineScan>& line) {
  copy(wire.utime, line.utime);
  copy(wire.seq, line.seq);
  copy(wire.beam_period_s, line.beam_period_s);
  copy(wire.first_angle_rad, line.first_angle_rad);
  copy(wire.angle_step_rad, line.angle_step_rad);
  copy.List("num_beams", wire.num_beams, wire.range_m, line.range);
  copy(wire.intensity, line.intensity);
}

line_scan_t ToWire(const LineScan& line) {
  CheckLength("intensity", line.intensity.size(), line.range.size());
  auto wire = FieldsToWire<line_scan_t>(line);
  wire.intensity.resize(line.range.size(), std::numeric_limits<float>::quiet_NaN());
  return wire;
}

void Check(const line_scan_t& wire) {
  CheckUtime("utime", wire.utime);
  // Times its beams are times, too.
  if (!(wire.beam_period_s >= 0 && wire.beam_period_s <= 1)) {
    Fail("beam_period_s", wire.beam_period_s, "0 to 1 s");
  }
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

LineScan FromWire(const line_scan_t& wire) { return FieldsFromWire<LineScan>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, encoder_t>& wire,
            StructOf<Copy, EncoderReading>& reading) {
  copy(wire.utime, reading.utime);
  copy(wire.seq, reading.seq);
  copy(wire.ticks, reading.ticks);
  copy(wire.sweep_utime, reading.sweep_utime);
}

encoder_t ToWire(const EncoderReading& reading) { return FieldsToWire<encoder_t>(reading); }

void Check(const encoder_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckRange("ticks", wire.ticks, -kMaxInteger, kMaxInteger);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
}

EncoderReading FromWire(const encoder_t& wire) { return FieldsFromWire<EncoderReading>(wire); }

}  // namespace rgbdt
