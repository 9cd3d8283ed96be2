#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/present/report/comparison_text.h"
#include "calib/present/report/said_once.h"
#include "calib/present/report/summary.h"
#include "calib/present/report/verdict.h"
#include "calib/present/report/words.h"
#include "services/command_line/command_line.h"
#include "services/rgbdt/verdict_ends.h"

namespace rgbdt {

/// Views that could not be read (`what` in other words), on stderr: what is wrong alike in many is
/// said once.
inline void PrintUnreadable(const std::vector<std::string>& unreadable,
                            const std::string& what = "not read") {
  for (const std::string& line : SaidOnce(OfViews(unreadable), what)) {
    std::fprintf(stderr, "rgbdt: %s\n", line.c_str());
  }
}

/// Throws InputError where not one of the session's views could be read.
inline void RequireReadable(const Session& session, const std::vector<std::string>& unreadable) {
  if (unreadable.empty() || unreadable.size() < session.views.size()) return;
  throw InputError("nothing of " + session.Title() +
                   " could be read: " + Joined(SaidOnce(OfViews(unreadable), "not read")));
}

/// Before a run begins that writes its results into `out`: those of an earlier one are set aside,
/// and stderr tells it. However the run ends, what is there then is its own. Throws InputError
/// where nothing can be written there.
inline void SetAside(const std::filesystem::path& out) {
  CheckWritable(out / "report.json");
  const std::string kept = SetResultsAside(out);
  if (!kept.empty()) std::fprintf(stderr, "%s\n", kept.c_str());
}

inline void AddJson(CommandLine* verb, bool* json) {
  verb->Flag("--json", json,
             "for programs: print report.json (calib/files/schema/report.proto) on stdout, and\n"
             "nothing else there");
}

/// What a verb says that made a report: the table and the files (`wrote`, in words), or report.json
/// of `out` alone (`json`). Of views that could not be read PrintUnreadable tells the reason.
inline void PrintReport(bool json, const Report& report, const std::filesystem::path& out,
                        const std::string& wrote, const std::vector<std::string>& unreadable) {
  if (json) {
    std::fputs(ReadWholeFile(out / "report.json").c_str(), stdout);
    return;
  }
  std::vector<std::string> told;
  for (const Said& said : OfViews(unreadable)) told.push_back(said.text);
  std::fputs(Summary(report).FullReport(told).c_str(), stdout);
  std::printf("%s report.json, report.html\n", wrote.c_str());
}

/// In words and figures. False: a camera moved, or its colours did.
inline bool PrintComparisons(const std::vector<CalibrationComparison>& comparisons) {
  bool same = true;
  for (const CalibrationComparison& comparison : comparisons) {
    std::printf("%s", ComparisonText(comparison).c_str());
    for (const PoseComparison& camera : comparison.cameras)
      same = same && !Moved(camera) && !ColoursMoved(camera);
  }
  return same;
}

}  // namespace rgbdt
