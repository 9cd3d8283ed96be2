#pragma once

#include "calib/model/rig.h"

namespace rgbdt::test {

/// f = 100 px, 41 x 31 px: a point (x, y, z) projects to (20 + 100 x / z, 15 + 100 y / z).
inline CameraSpec SpecOf(CameraKind kind) {
  CameraSpec spec;
  spec.kind = kind;
  spec.name = kind == CameraKind::kThermal ? "thermal" : "rgb";
  spec.width = 41;
  spec.height = 31;
  spec.lens = {Lens::Model::kPinhole, 100, 100, 20, 15, {}};
  if (kind == CameraKind::kThermal) {
    spec.format = PixelFormat::kMono16;
    spec.radiometry.kind = Radiometry::Kind::kLinear;
    spec.radiometry.gain = 0.04;
  }
  return spec;
}

}  // namespace rgbdt::test
