#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <string>

namespace rgbdt {

/// What a test measured, for scripts/study: a line "NAME VALUE UNIT", printed, and at the end of
/// the file that RGBDT_FIGURES names, where it does.
inline void TellFigure(const std::string& name, double value, const std::string& unit = "1") {
  std::printf("%s %.9g %s\n", name.c_str(), value, unit.c_str());
  const char* path = std::getenv("RGBDT_FIGURES");
  if (path == nullptr) return;
  std::ofstream(path, std::ios::app)
      << name << ' ' << std::setprecision(9) << value << ' ' << unit << '\n';
}

/// How many of `all` there are, as a share.
inline void TellShare(const std::string& name, std::size_t count, std::size_t all) {
  TellFigure(name, static_cast<double>(count) / static_cast<double>(all));
}

}  // namespace rgbdt
