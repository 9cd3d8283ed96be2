#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/files/session_dir.h"
#include "calib/model/calibration.h"

namespace rgbdt {

/// Writes report.json and report.html; for each camera the page shows one held-out view (or, with
/// none, one used) with the cloud's boundary points laid on the image by the calibration.
void WriteReportFiles(const std::filesystem::path& dir, const Session& session,
                      const std::vector<Observation>& observations, const Report& report);

/// calibration.textproto into `dir`, unless no camera was solved: a guess must not take the place
/// of what an earlier run found. Returns what it did, in words: "wrote DIR/calibration.textproto,".
std::string WriteIfSolved(const std::filesystem::path& dir, const Report& report);

}  // namespace rgbdt
