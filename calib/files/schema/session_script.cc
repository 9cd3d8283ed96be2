#include "calib/files/schema/session_script.h"

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/schema/session.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using text::Place;
using Kind = SessionStep::Kind;

constexpr double kDefaultTimeout = 60;

// An error in a step names its number, counted from 1.
[[noreturn]] void FailStep(const Place& place, int index, const std::string& problem) {
  throw InputError(place.Describe() + " " + std::to_string(index + 1) + " " + problem);
}

double CheckSeconds(double seconds, const Place& place, int index, const std::string& field) {
  constexpr double kMost = 7 * 24 * 3600.;
  if (!(seconds >= 0 && seconds <= kMost)) {
    FailStep(place, index,
             "has " + field + " " + Format("%g", seconds) + "; expected seconds, a week at most");
  }
  return seconds;
}

SessionStep ToStep(const proto::Step& message, const Place& place, int index) {
  SessionStep step;
  switch (message.step_case()) {
    case proto::Step::kNextPose:
      step.kind = Kind::kNextPose;
      break;
    case proto::Step::kSweep:
      step.kind = Kind::kSweep;
      break;
    case proto::Step::kCapture:
      step.kind = Kind::kCapture;
      step.heldout = message.capture().heldout();
      step.picked_cameras.assign(message.capture().picked_camera().begin(),
                                 message.capture().picked_camera().end());
      break;
    case proto::Step::kWait:
      step.kind = Kind::kWait;
      step.wait_s = CheckSeconds(message.wait().seconds(), place, index, "wait.seconds");
      break;
    case proto::Step::kSolve:
      step.kind = Kind::kSolve;
      break;
    case proto::Step::kEvaluate:
      step.kind = Kind::kEvaluate;
      break;
    case proto::Step::kSave:
      step.kind = Kind::kSave;
      break;
    case proto::Step::STEP_NOT_SET:
      FailStep(place, index,
               "is empty; expected next_pose, sweep, capture, wait, solve, evaluate or save");
  }
  step.timeout_s = CheckSeconds(message.timeout_s(), place, index, "timeout_s");
  if (step.timeout_s == 0) step.timeout_s = kDefaultTimeout;
  return step;
}

// What a step needs, earlier ones must have done.
class OrderCheck {
 public:
  // Returns what is wrong, or nothing.
  std::string Next(const SessionStep& step) {
    switch (step.kind) {
      case Kind::kNextPose:
        swept_ = false;
        break;
      case Kind::kSweep:
        swept_ = true;
        break;
      case Kind::kCapture:
        if (!swept_) return "captures, but there was no sweep since the last pose or capture";
        swept_ = false;
        captured_ = true;
        break;
      case Kind::kSolve:
        if (!captured_) return "solves, but nothing was captured before it";
        solved_ = true;
        break;
      case Kind::kEvaluate:
        if (!solved_) return "evaluates, but nothing was solved before it";
        break;
      case Kind::kWait:
      case Kind::kSave:
        break;
    }
    return {};
  }

 private:
  bool swept_ = false, captured_ = false, solved_ = false;
};

}  // namespace

SessionScript ReadSessionScript(const std::filesystem::path& path,
                                const std::filesystem::path& rig_path) {
  proto::SessionScript message;
  Place::Tree tree;
  const Place place = text::ParseText(ReadWholeFile(path), path.string(), &message, &tree);
  if (message.step_size() == 0) place.Fail("step", "is missing; the script does nothing");
  if (message.rig().empty() && rig_path.empty()) {
    place.Fail("rig", "is missing; expected the path of rig.textproto");
  }
  SessionScript script;
  script.name = message.name();
  script.rig = rig_path.empty() ? path.parent_path() / message.rig() : rig_path;
  Rig rig;
  try {
    rig = ReadRig(script.rig);
  } catch (const InputError& error) {
    throw InputError(place.Describe("rig") + ": " + error.what());
  }
  OrderCheck order;
  for (int i = 0; i < message.step_size(); ++i) {
    script.steps.push_back(ToStep(message.step(i), place.In("step", i), i));
    const std::string problem = order.Next(script.steps.back());
    if (!problem.empty()) FailStep(place.In("step", i), i, problem);
    for (const std::string& camera : script.steps.back().picked_cameras) {
      try {
        rig.Camera(camera);
      } catch (const InputError& error) {
        FailStep(place.In("step", i), i, std::string("picked_camera: ") + error.what());
      }
    }
  }
  return script;
}

}  // namespace rgbdt
