#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, corner_selection_t>& wire,
            StructOf<Copy, CornerSelection>& selection) {
  copy(wire.utime, selection.utime);
  copy(wire.seq, selection.seq);
  copy(wire.camera, selection.camera);
  copy(wire.image_utime, selection.image_utime);
  copy(wire.corner_px, selection.corners);
}

corner_selection_t ToWire(const CornerSelection& selection) {
  return FieldsToWire<corner_selection_t>(selection);
}

void Check(const corner_selection_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckCameraName("camera", wire.camera);
  CheckUtime("image_utime", wire.image_utime);
  CheckFinite("corner_px", wire.corner_px[0], 8);
}

CornerSelection FromWire(const corner_selection_t& wire) {
  return FieldsFromWire<CornerSelection>(wire);
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, target_status_t>& wire,
            StructOf<Copy, TargetStatus>& status) {
  copy(wire.utime, status.utime);
  copy(wire.seq, status.seq);
  copy(wire.camera, status.camera);
  copy(wire.seen, status.seen);
  copy(wire.text, status.text);
  copy.List("num_corners", wire.num_corners, wire.corner_px, status.corners);
  copy.List("num_outline", wire.num_outline, wire.outline_px, status.outline);
  copy(wire.centre_m, status.centre);
}

target_status_t ToWire(const TargetStatus& status) { return FieldsToWire<target_status_t>(status); }

void Check(const target_status_t& wire) {
  CheckUtime("utime", wire.utime);
  if (!wire.camera.empty()) CheckCameraName("camera", wire.camera);
  CheckText("text", wire.text);
  CheckRows("corner_px", wire.corner_px);
  CheckRows("outline_px", wire.outline_px);
  CheckFinite("centre_m", wire.centre_m, 3);
}

TargetStatus FromWire(const target_status_t& wire) { return FieldsFromWire<TargetStatus>(wire); }

}  // namespace rgbdt
