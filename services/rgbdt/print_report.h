#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "calib/present/report/comparison_text.h"
#include "calib/present/report/summary.h"

namespace rgbdt {

/// How a verb that made a report ends: the table, the files (`wrote`, in words), and a line on
/// stderr for each view that could not be read.
inline void PrintReport(const Report& report, const std::string& wrote,
                        const std::vector<std::string>& unreadable) {
  std::fputs(Summary(report).FullReport().c_str(), stdout);
  std::printf("%s report.json, report.html\n", wrote.c_str());
  for (const std::string& line : unreadable) std::fprintf(stderr, "rgbdt: %s\n", line.c_str());
}

/// In words and figures. False: a camera moved.
inline bool PrintComparisons(const std::vector<CalibrationComparison>& comparisons) {
  bool moved = false;
  for (const CalibrationComparison& comparison : comparisons) {
    std::printf("%s", ComparisonText(comparison).c_str());
    for (const PoseComparison& camera : comparison.cameras) moved = moved || Moved(camera);
  }
  return !moved;
}

}  // namespace rgbdt
