#pragma once

#include <algorithm>
#include <string>

#include "calib/present/report/summary.h"
#include "calib/present/report/verdict.h"
#include "services/command_line/command_line.h"

namespace rgbdt {

/// How a program ends that made or judged a report: failed where a camera or a LIDAR did not
/// converge, else by the worst verdict. A pose that was found and is not to be used is judged.
inline ExitCode EndOf(const Report& report) {
  const bool judged =
      std::any_of(report.cameras.begin(), report.cameras.end(), [](const CameraReport& camera) {
        return camera.calibration.status == SolveStatus::kContradicted;
      });
  if (!judged && !Summary(report).converged()) return ExitCode::kFailed;
  const Grade grade = GradeOf(report);
  return grade >= Grade::kNone       ? ExitCode::kDoNotUse
         : grade == Grade::kDoubtful ? ExitCode::kDoubtful
                                     : ExitCode::kDone;
}

/// The worse of two ends.
inline ExitCode WorseOf(ExitCode a, ExitCode b) {
  const auto badness = [](ExitCode code) {
    return code == ExitCode::kDone       ? 0
           : code == ExitCode::kDoubtful ? 1
           : code == ExitCode::kFailed   ? 2
                                         : 3;
  };
  return badness(a) < badness(b) ? b : a;
}

/// What `--help` says of the verdicts' exit codes.
inline void AddVerdictEnds(CommandLine* line, const std::string& verbs = "") {
  line->Ends(ExitCode::kDoubtful, verbs + "the verdict on a camera is `doubtful`");
  line->Ends(ExitCode::kDoNotUse, verbs + "the verdict on a camera is `do not use`");
}

}  // namespace rgbdt
