#pragma once

// What a report says of the solve and of how well it fits. A table is empty where the report has
// nothing to say.

#include "calib/model/calibration.h"
#include "calib/present/report/table.h"

namespace rgbdt {

/// What a method's fit is told in: the paper's in the distance transform, which for others is a
/// number that says nothing of their quality.
enum class FitFigure { kSigmas, kDistanceTransform };

Table FitTable(const CameraReport& camera, FitFigure figure);

/// Every view once, in the session's order: its figures where there are some, else why not.
Table ViewsTable(const CameraReport& camera, FitFigure figure);

/// What detection found in each view: each camera's image and the cloud apart.
Table DetectionTable(const Report& report);

Table StartsTable(const CameraReport& camera, FitFigure figure);
Table SolveTable(const CameraReport& camera);

/// What the LIDAR's ranges and beams are off by.
Table LidarTable(const CameraReport& camera);

}  // namespace rgbdt
