#pragma once

// What a report says of its uncertainty. A table is empty where the report has nothing to say.

#include "calib/model/calibration.h"
#include "calib/present/report/table.h"

namespace rgbdt {

Table PoseSigmaTable(const CameraReport& camera);
Table ProjectionTable(const CameraReport& camera);
Table PartsTable(const CameraReport& camera);
Table FoldsTable(const CameraReport& camera);
Table NuisanceTable(const CameraReport& camera);

/// The cameras against each other.
Table ClosureTable(const Report& report);

}  // namespace rgbdt
