#include "services/nodes/internal/session_steps.h"

namespace rgbdt {

std::string AnsweredBy(SessionStep::Kind kind) {
  switch (kind) {
    case SessionStep::Kind::kCapture:
      return "detector";
    case SessionStep::Kind::kSolve:
    case SessionStep::Kind::kEvaluate:
      return "solver";
    default:
      return "";
  }
}

std::string NameOf(SessionStep::Kind kind) {
  switch (kind) {
    case SessionStep::Kind::kNextPose:
      return "next pose";
    case SessionStep::Kind::kSweep:
      return "sweep";
    case SessionStep::Kind::kCapture:
      return "capture";
    case SessionStep::Kind::kWait:
      return "wait";
    case SessionStep::Kind::kSolve:
      return "solve";
    case SessionStep::Kind::kEvaluate:
      return "evaluate";
    case SessionStep::Kind::kSave:
      return "save";
  }
  return "";
}

}  // namespace rgbdt
