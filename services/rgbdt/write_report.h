#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/methods/detect_session.h"
#include "calib/model/calibration.h"

namespace rgbdt {

/// How a verb that made a report ends: compares with `truth` (a file; empty: the session's own,
/// where there is one), writes report.json and report.html, and prints the table, the files (after
/// `wrote`, what was written before) and the views that could not be read. For each camera the page
/// shows one held-out view (or, with none, one used) with the cloud's boundary points laid on the
/// image by the calibration; where the viewer's page was built, it is that page with the whole
/// session in it. Returns whether all the views could be read.
bool FinishReport(const std::filesystem::path& dir, const std::string& truth,
                  const std::string& wrote, const Session& session,
                  const SessionDetection& detection, Report* report);

/// calibration.textproto into `dir`, unless no camera was solved: a guess must not take the place
/// of what an earlier run found. Returns what it did, in words: "wrote DIR/calibration.textproto,".
std::string WriteIfSolved(const std::filesystem::path& dir, const Report& report);

}  // namespace rgbdt
