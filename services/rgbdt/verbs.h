#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "services/command_line/command_line.h"

namespace rgbdt {

/// Each adds a verb to the program. Bad input is thrown as InputError; the command line prints it.
void AddCalibrate(CommandLine* program);
void AddEvaluate(CommandLine* program);
void AddCompare(CommandLine* program);
void AddFuse(CommandLine* program);
void AddSession(CommandLine* program);
void AddSimulate(CommandLine* program);
void AddReplay(CommandLine* program);
void AddIntrinsics(CommandLine* program);
void AddScanner(CommandLine* program);
void AddMap(CommandLine* program);
void AddTerrain(CommandLine* program);
void AddExport(CommandLine* program);
void AddDoctor(CommandLine* program);

/// What the user gave, or else the default.
inline std::filesystem::path PathOr(const std::string& given,
                                    const std::filesystem::path& otherwise) {
  return given.empty() ? otherwise : std::filesystem::path(given);
}

/// The truth file that the user named, or else the session's own; empty: there is none.
inline std::filesystem::path TruthPath(const std::string& given,
                                       const std::filesystem::path& session_root) {
  const std::filesystem::path beside = session_root / "truth.textproto";
  return given.empty() && !std::filesystem::exists(beside) ? "" : PathOr(given, beside);
}

/// What `rgbdt intrinsics` does for these cameras of a session, into the rig file that is in use.
/// False: a lens was not found.
bool FindLenses(const std::string& session_dir, const std::vector<std::string>& cameras);

/// A line of progress, on stderr.
inline void PrintProgress(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

}  // namespace rgbdt
