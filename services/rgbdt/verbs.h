#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/import/folders.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "services/command_line/command_line.h"

namespace rgbdt {

/// Each adds a verb to the program. Bad input is thrown as InputError; the command line prints it.
void AddCalibrate(CommandLine* program);
void AddEvaluate(CommandLine* program);
void AddRefine(CommandLine* program);
void AddCompare(CommandLine* program);
void AddFuse(CommandLine* program);
void AddSession(CommandLine* program);
/// `packets`: for what holds a LIDAR's packets; none: the build has no drivers.
struct PacketImport;
void AddImport(CommandLine* program, const PacketImport* packets);
void AddSimulate(CommandLine* program);
void AddReplay(CommandLine* program);
void AddIntrinsics(CommandLine* program);
void AddScanner(CommandLine* program);
void AddSync(CommandLine* program);
void AddMap(CommandLine* program);
void AddTerrain(CommandLine* program);
void AddExport(CommandLine* program);
void AddUp(CommandLine* program);
void AddKey(CommandLine* program);
void AddDoctor(CommandLine* program);

/// What the user gave, or else the default.
inline std::filesystem::path PathOr(const std::string& given,
                                    const std::filesystem::path& otherwise) {
  return given.empty() ? otherwise : std::filesystem::path(given);
}

/// Of the file that the user named, or else the session's own; none: there is none.
inline std::optional<Truth> ReadTruthOf(const std::string& given,
                                        const std::filesystem::path& session_root) {
  const std::filesystem::path file = PathOr(given, session_root / "truth.textproto");
  if (given.empty() && !std::filesystem::exists(file)) return std::nullopt;
  return ReadTruth(file);
}

/// A calibration that a verb uses, and the rig that it is used with.
struct CalibrationFiles {
  std::filesystem::path calibration, rig;
  bool anyway = false;  ///< the user said `--anyway`

  UseNames Names() const { return {calibration.string(), rig.string()}; }
  Use HowToUse() const { return anyway ? Use::kAnyway : Use::kIfSound; }
};

/// Of DIR, and the calibration there unless another is given.
inline CalibrationFiles FilesOf(const std::filesystem::path& dir, const std::string& calibration,
                                bool anyway) {
  return {PathOr(calibration, dir / "calibration.textproto"), dir / "rig.textproto", anyway};
}

/// Throws InputError where the session has not been calibrated, too.
inline Calibration ReadCalibrationOf(const CalibrationFiles& files) {
  if (!std::filesystem::exists(files.calibration)) {
    throw InputError(files.calibration.string() + " is missing: run rgbdt calibrate first");
  }
  return ReadCalibration(files.calibration);
}

/// What is used all the same, on stderr.
inline void PrintWarnings(const std::vector<std::string>& against) {
  for (const std::string& line : against) {
    std::fprintf(stderr, "rgbdt: used anyway: %s\n", line.c_str());
  }
}

/// What is doubtful about a calibration that is used, on stderr.
inline void PrintDoubts(const Calibration& calibration, const Rig& rig,
                        const std::filesystem::path& file) {
  for (const std::string& line : DoubtsOf(calibration, rig, file.string())) {
    std::fprintf(stderr, "rgbdt: %s\n", line.c_str());
  }
}

/// Of a verb that uses a calibration.
inline void AddAnyway(CommandLine* verb, bool* anyway, const std::string& although) {
  verb->Flag("--anyway", anyway, "use the calibration although " + although);
}

/// What `rgbdt intrinsics` does for these cameras of a session, into the rig file that is in use.
/// False: a lens was not found.
bool FindLenses(const std::string& session_dir, const std::vector<std::string>& cameras);

/// "NAME=PATH", or a path alone, without a name.
std::pair<std::string, std::string> SplitName(const std::string& text);

/// "[NAME=]FILE[:PART]" of `--lens`.
Folders::LensFile LensFileOf(const std::string& text);

/// How `session` and `import` end once the session is written: the lenses of these cameras are
/// found from its images, and what to do next is said. Gives the exit code.
int FinishSession(const std::string& session_dir, const std::vector<std::string>& unknown);

/// A line of progress, on stderr.
inline void PrintProgress(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

/// A line for each tenth of the way, 0 to 1.
inline std::function<void(double)> Tenths(const std::string& what) {
  auto last = std::make_shared<int>(0);
  return [what, last](double done) {
    const int tenth = static_cast<int>(10 * done);
    if (tenth <= *last || tenth >= 10) return;
    *last = tenth;
    PrintProgress(what + ": " + std::to_string(10 * tenth) + "%");
  };
}

}  // namespace rgbdt
