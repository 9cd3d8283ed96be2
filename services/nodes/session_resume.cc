// How a session begins, and goes on with what an earlier start of it left.
#include <algorithm>
#include <iterator>
#include <utility>

#include "calib/files/session/session_dir.h"
#include "calib/model/text.h"
#include "services/nodes/internal/session_steps.h"
#include "services/nodes/session_node.h"

namespace rgbdt {
namespace {

constexpr Utime kStartTimeout = 30 * kMicrosecondsPerSecond;  // until everybody is ready

}  // namespace

Messages SessionNode::Start() {
  const std::string who = WhoIsNotReady();
  if (!who.empty()) {
    if (!by_request_ && now_ - *began_ > kStartTimeout) Fail("not ready after 30 s: " + who);
    return {};
  }
  SetEarlierResultsAside();
  const bool goes_on = !earlier_.empty() || resume_.asked;
  if (!goes_on) RemoveTraces(directory_);
  WriteRig(directory_, rig_);
  started_ = true;
  solver_views_.Clear();
  Messages out = Send(goes_on ? SessionVerb::kGoOn : SessionVerb::kReset);
  const auto add = [&](Messages messages) {
    std::move(messages.begin(), messages.end(), std::back_inserter(out));
  };
  if (goes_on) add(GoOnWithEarlierViews());
  if (!by_request_) {
    add(Begin());
  } else if (idle()) {
    PublishEvent(EventKind::kDone, "ready", 1);
  }
  return out;
}

// As if they had just been taken; the solver is told of them.
Messages SessionNode::GoOnWithEarlierViews() {
  newest_utime_ = std::max(newest_utime_, earlier_.NewestUtime());
  for (const auto& [name, detection] : earlier_.detected) {
    solver_views_.Add(detection);
    solver_views_.Require(name);
    for (const ImageDetection& image : detection.images) {
      images_[{image.camera, image.utime}] = name;
    }
  }
  if (earlier_.left_out) solver_views_.Set(*earlier_.left_out);
  index_ = resume_.step;
  view_number_ = resume_.view_number;
  if (view_number_ > 0) view_ = ViewName(view_number_);
  view_taken_ = true;
  Tell("goes on with the " + std::to_string(earlier_.detected.size()) + " views that are in " +
       directory_.string() + (resume_.asked ? ", and waits for view " + view_ : ""));
  if (!resume_.unfinished.empty()) {
    Tell("view " + resume_.unfinished + " was not finished and is taken again; the first one is " +
         SetViewAside(directory_, resume_.unfinished));
    earlier_.undetected.erase(resume_.unfinished);
  }
  if (by_request_ && !earlier_.undetected.empty()) {
    std::string names;
    for (const std::string& name : earlier_.undetected) names += (names.empty() ? "" : ", ") + name;
    Tell("view " + names + " was not detected and does not count here; rgbdt calibrate " +
         ForShell(directory_.string()) + " takes all views that are there");
  }
  if (by_request_ && resume_.asked) {
    const SessionCommand& asked = *earlier_.asked;
    if (asked.verb == SessionVerb::kNextPose) {
      Append(SessionStep::Kind::kNextPose);
    } else {
      AppendCapture(asked.heldout);
      index_ = asked.verb == SessionVerb::kSweep ? 0 : 1;
    }
  } else if (by_request_ && !earlier_.detected.empty()) {
    Append(SessionStep::Kind::kSolve);
    Append(SessionStep::Kind::kEvaluate);
  }
  return solver_views_.Again();
}

// For what an earlier start of this session asked for: it is asked as it was, and who is at it, or
// has done it, answers.
Messages SessionNode::GoOnWaiting() {
  waiting_ = true;
  answered_ = false;
  timeout_.Begin(now_, step().timeout_s);
  newest_command_ = *earlier_.asked;
  command_ = newest_command_.command;
  view_taken_ = false;
  repeat_pause_ = kFirstRepeat;
  repeat_at_ = now_ + repeat_pause_;
  if (step().kind == SessionStep::Kind::kCapture) {
    sweep_utime_ = newest_command_.sweep_utime;
    captures_[command_] = newest_command_;
    collector_.Begin(newest_command_);
  }
  Announce("goes on waiting: " + NameOf(step().kind));
  return {newest_command_};
}

}  // namespace rgbdt
