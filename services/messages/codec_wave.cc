#include <cmath>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, waved_clock_t>& wire,
            StructOf<Copy, WavedClock>& clock) {
  copy(wire.camera, clock.camera);
  copy(wire.text, clock.text);
}

waved_clock_t ToWire(const WavedClock& clock) {
  auto wire = FieldsToWire<waved_clock_t>(clock);
  wire.told = clock.time_offset_s.has_value() ? 1 : 0;
  wire.time_offset_s = clock.time_offset_s.value_or(Estimate()).value;
  wire.time_offset_sigma_s = clock.time_offset_s.value_or(Estimate()).sigma;
  return wire;
}

void Check(const waved_clock_t& wire) {
  CheckCameraName("clocks.camera", wire.camera);
  CheckText("clocks.text", wire.text);
  if (wire.told == 0) return;
  if (!(std::abs(wire.time_offset_s) <= kMaxTimeOffsetS)) {
    Fail("clocks.time_offset_s", wire.time_offset_s, "-60 to 60");
  }
  CheckNotNegative("clocks.time_offset_sigma_s", wire.time_offset_sigma_s);
}

WavedClock FromWire(const waved_clock_t& wire) {
  auto clock = FieldsFromWire<WavedClock>(wire);
  if (wire.told != 0) clock.time_offset_s = {wire.time_offset_s, wire.time_offset_sigma_s};
  return clock;
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, wave_progress_t>& wire,
            StructOf<Copy, WaveProgress>& progress) {
  copy(wire.utime, progress.utime);
  copy(wire.seq, progress.seq);
  copy(wire.phase, progress.phase);
  copy(wire.left_s, progress.left_s);
  copy(wire.text, progress.text);
  copy.List("num_clocks", wire.num_clocks, wire.clocks, progress.clocks);
}

wave_progress_t ToWire(const WaveProgress& progress) {
  return FieldsToWire<wave_progress_t>(progress);
}

void Check(const wave_progress_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckRange("phase", wire.phase, wave_progress_t::WAITING, wave_progress_t::FAILED);
  CheckNotNegative("left_s", wire.left_s);
  CheckText("text", wire.text);
  CheckRange("num_clocks", wire.num_clocks, 0, kMaxCameras);
  for (const waved_clock_t& clock : wire.clocks) Check(clock);
}

WaveProgress FromWire(const wave_progress_t& wire) { return FieldsFromWire<WaveProgress>(wire); }

}  // namespace rgbdt
