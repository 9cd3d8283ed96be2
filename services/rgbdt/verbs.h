#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>

namespace rgbdt {

/// Each verb of the command line adds its options to `app` and, when chosen, runs and sets
/// `*exit_code`. Bad input is thrown as InputError; main prints it.
void AddCalibrate(CLI::App* app, int* exit_code);
void AddEvaluate(CLI::App* app, int* exit_code);
void AddFuse(CLI::App* app, int* exit_code);
void AddSimulate(CLI::App* app, int* exit_code);
void AddReplay(CLI::App* app, int* exit_code);
void AddIntrinsics(CLI::App* app, int* exit_code);
void AddScanner(CLI::App* app, int* exit_code);
void AddMap(CLI::App* app, int* exit_code);
void AddTerrain(CLI::App* app, int* exit_code);
void AddExport(CLI::App* app, int* exit_code);
void AddDoctor(CLI::App* app, int* exit_code);

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

/// A line of progress, on stderr.
inline void PrintProgress(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

}  // namespace rgbdt
