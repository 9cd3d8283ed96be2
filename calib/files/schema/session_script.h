#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rgbdt {

/// One step of a scripted session.
struct SessionStep {
  enum class Kind { kNextPose, kSweep, kCapture, kWait, kSolve, kEvaluate, kSave };
  Kind kind = Kind::kNextPose;
  bool heldout = false;                     ///< capture: keep this view from the solver
  std::vector<std::string> picked_cameras;  ///< capture: where a person picks the corners
  double wait_s = 0;                        ///< wait: of the wall clock [s]
  double timeout_s = 60;                    ///< of the wall clock [s]
};

struct SessionScript {
  std::string name;
  std::filesystem::path rig;  ///< rig.textproto
  std::vector<SessionStep> steps;
};

/// Reads a session.textproto (schema: calib/files/schema/session.proto). `rig` takes the place of
/// the rig file that the script names (which is relative to the script). Throws InputError with
/// file, line and the number of the step: an empty step, a negative time, a capture without a
/// sweep, a solve before any capture, an evaluate before any solve, picks for a camera that the rig
/// does not have, a rig that cannot be read.
SessionScript ReadSessionScript(const std::filesystem::path& path,
                                const std::filesystem::path& rig = {});

}  // namespace rgbdt
