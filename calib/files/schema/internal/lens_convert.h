#pragma once

#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"

namespace rgbdt::text {

// All throw InputError for lists of a wrong length and numbers that are not finite.

/// Not known where the message has none.
Lens ToLens(const proto::Camera& camera, const Place& place);
SolvedLens ToSolvedLens(const proto::SolvedLens& lens, const Place& place);
/// Of this camera's lens.
LensUncertainty ToLensUncertainty(const proto::LensUncertainty& uncertainty,
                                  const CameraSpec& camera, const Place& place);

/// A lens that is not known stays so, and keeps its model where that is not the usual one.
void FromLens(const Lens& lens, proto::Camera* out);
void FromSolvedLens(const SolvedLens& lens, proto::SolvedLens* out);
/// Of this camera's lens; it must state one.
void FromLensUncertainty(const CameraSpec& camera, proto::LensUncertainty* out);

}  // namespace rgbdt::text
