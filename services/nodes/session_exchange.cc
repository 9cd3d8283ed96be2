// What detector and session say again of a view for the one of them that lacks it.
#include <utility>

#include "services/nodes/session_node.h"

namespace rgbdt {

// What it had of a view that is begun is lost, and so may be what it said last.
void SessionNode::OnDetectorStartedAnew(const std::string& why) {
  const bool captures = waiting_ && !idle() && step().kind == SessionStep::Kind::kCapture;
  if (captures) answered_ |= IsDetected();
  if (captures && answered_) return;
  if (captures && exchange_.deaths++ > 0) {  // of what it was told, perhaps
    TakeAgain(why, &restarts_, kMaxRestarts);
    return;
  }
  exchange_.detector_lacks = why;
  exchange_.detector_is_new = true;
  exchange_.tries = 0;
  exchange_.next_try = now_;
}

// Of the view at hand: what the detector lacks is told it, once it hears; what this process lacks
// it is asked for.
Messages SessionNode::SayWhatIsLacking() {
  if (!waiting_ || finished_ || step().kind != SessionStep::Kind::kCapture) return {};
  const bool lacks = !answered_ && !exchange_.detector_lacks.empty();
  if (lacks && !exchange_.torn_here.empty()) {
    TakeTornAgain(exchange_.torn_here);
    return {};
  }
  const auto detector = statuses_.find("detector");
  const bool hears = detector != statuses_.end() && detector->second.ready;
  const bool tells = lacks && has_view_ && hears;
  const bool asks = answered_ && !(has_view_ && IsDetected());
  if ((!tells && !asks) || now_ < exchange_.next_try || exchange_.tries == kMostExchanges)
    return {};
  exchange_.next_try = now_ + (kFirstRepeat << exchange_.tries);
  if (exchange_.tries++ == 0) timeout_.AskedAgain(now_);
  if (asks) {
    SessionCommand say = captures_.at(command_);
    say.command = 0;  // each asking is a new one
    say.verb = SessionVerb::kSayView;
    Warn(WithView(WhatIsMissing() + "; rgbdt-detector is asked for it"));
    return {say};
  }
  Warn(WithView(exchange_.detector_lacks + "; it is told the view again"));
  Messages told;
  if (exchange_.detector_is_new) told.emplace_back(newest_command_);
  for (Message& part : collector_.Again(exchange_.view)) told.push_back(std::move(part));
  return told;
}

}  // namespace rgbdt
