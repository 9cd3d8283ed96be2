#pragma once

#include <filesystem>
#include <string>

#include "calib/present/session/session_frames.h"

namespace rgbdt {

/// calibration.textproto (JudgedCalibration) into `dir`, unless no camera was solved: a guess must
/// not take the place of what an earlier run found. The earlier one's timings stay, in the report,
/// too (KeepTimings).
/// Returns what it did, in words: "wrote DIR/calibration.textproto,".
std::string WriteIfSolved(const std::filesystem::path& dir, const Rig& rig, Report* report);

/// report.json and report.html into `dir`. The HTML file is the viewer's page with the whole
/// session in it or, where the build has no such page, a plain one: for each camera it shows one
/// held-out view (or, with none, one used) with the cloud's boundary points laid on the image by
/// the calibration.
void WriteReportFiles(const std::filesystem::path& dir, const FinishedSession& finished);

}  // namespace rgbdt
