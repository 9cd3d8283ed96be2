#include "services/messages/check.h"
#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {

sighting_t ToWire(const Sighting& sighting) {
  sighting_t wire;
  wire.utime = sighting.utime;
  wire.seq = sighting.seq;
  wire.camera = sighting.camera;
  wire.seen = static_cast<std::int8_t>(sighting.seen);
  wire.text = sighting.text;
  wire.num_corners = CountOf(sighting.corners.size(), "num_corners");
  wire.corner_px = RowsToWire(sighting.corners);
  wire.num_outline = CountOf(sighting.outline.size(), "num_outline");
  wire.outline_px = RowsToWire(sighting.outline);
  for (int i = 0; i < 3; ++i) wire.centre_m[i] = sighting.centre[i];
  return wire;
}

void Check(const sighting_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckSeq(wire.seq);
  if (!wire.camera.empty()) CheckCameraName("camera", wire.camera);
  CheckText("text", wire.text);
  CheckRows("corner_px", wire.corner_px);
  CheckRows("outline_px", wire.outline_px);
  CheckFinite("centre_m", wire.centre_m, 3);
}

Sighting FromWire(const sighting_t& wire) {
  Sighting sighting;
  sighting.utime = wire.utime;
  sighting.seq = wire.seq;
  sighting.camera = wire.camera;
  sighting.seen = wire.seen != 0;
  sighting.text = wire.text;
  sighting.corners = RowsFromWire<Eigen::Vector2d>(wire.corner_px);
  sighting.outline = RowsFromWire<Eigen::Vector2d>(wire.outline_px);
  sighting.centre = Eigen::Vector3d(wire.centre_m);
  return sighting;
}

}  // namespace rgbdt
