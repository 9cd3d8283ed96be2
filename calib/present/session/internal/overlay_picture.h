#pragma once

#include <optional>

#include "calib/present/report/report_html.h"
#include "calib/present/session/session_frames.h"

namespace rgbdt {

/// One view of a camera with the cloud's boundary points laid on its image by the calibration: a
/// held-out view or, with none, one used. Nothing where there is none of either.
std::optional<ReportPicture> OverlayPicture(const FinishedSession& finished,
                                            const CameraCalibration& camera);

}  // namespace rgbdt
