#pragma once

#include <cstdio>
#include <string>
#include <vector>

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

}  // namespace rgbdt
