// What a session writes of its views, and where it cannot.
#include <algorithm>

#include "calib/files/session/session_dir.h"
#include "calib/model/text.h"
#include "calib/solve/options.h"
#include "services/nodes/session_node.h"

namespace rgbdt {

void SessionNode::SaveView() {
  if (finished_ || !collector_.active()) return;
  const std::string torn = collector_.sweeps().WhyTorn(collector_.capture().sweep_utime);
  if (!torn.empty()) {
    if (collector_.Missing(rig_).empty()) exchange_.torn_here = torn;
    return;
  }
  std::optional<View> view = collector_.Take(rig_);
  if (!view) return;
  const std::string name = view->name;
  has_view_ = true;
  exchange_.torn_here.clear();
  exchange_.view.cloud.sweep_utime = view->cloud.sweep_utime;
  exchange_.view.images = view->images;
  exchange_.view.picks = view->picks;
  taken_.insert(name);
  for (const Image& image : view->images) images_[{image.camera, image.utime}] = name;
  unwritten_.Add(std::move(*view));
  WriteToDisk();
  SaveDetection(name);
}

// Where it cannot be written, a session that is killed takes the view again.
void SessionNode::NoteAsked(const SessionCommand& command) const {
  try {
    WriteAsked(directory_, command);
  } catch (const std::exception&) {
  }
}

void SessionNode::SaveDetection(const std::string& view) {
  const ViewDetection* detection = solver_views_.Find(view);
  if (taken_.count(view) == 0 || detection == nullptr || !IsCaptured(*detection)) return;
  unwritten_.Add(*detection);
  WriteToDisk();
}

void SessionNode::SaveLeftOut(const LeftOutViews& left_out) {
  solver_views_.Set(left_out);
  unwritten_.Add(left_out);
  WriteToDisk();
}

// Corners for a view that was taken: it is written once more, with them.
void SessionNode::OnPicks(const CornerSelection& picks) {
  const auto found = images_.find({picks.camera, picks.image_utime});
  if (found == images_.end()) return;
  const std::string& name = found->second;
  const View* kept = unwritten_.Find(name);
  View view = kept != nullptr ? *kept : ReadView({directory_, rig_, {name}}, name);
  auto& all = view.picks;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const CornerSelection& p) { return p.camera == picks.camera; }),
            all.end());
  all.push_back(picks);
  unwritten_.Add(std::move(view));
  WriteToDisk();
}

// Says once that something stays in memory, and once that it no longer does.
void SessionNode::WriteToDisk() {
  if (unwritten_.empty()) return;
  const bool failed = unwritten_.failed();
  unwritten_.Write(now_);
  if (unwritten_.failed() == failed) return;
  Tell(failed ? "what was kept in memory is on disk" : unwritten_.Trouble());
  if (failed) timeout_.AskedAgain(now_);  // nobody else was waited for
}

std::string SessionNode::WriteWhatIsKept() {
  WriteToDisk();
  if (started_) RemoveAsked(directory_);
  return unwritten_.Lost();
}

// What a failure does not cost; empty: too little for a calibration.
std::string SessionNode::WhatIsOnDisk() const {
  const std::size_t views = earlier_.detected.size() + taken_.size() - unwritten_.views();
  if (!started_ || views < static_cast<std::size_t>(CalibrateOptions{}.min_views)) return {};
  return "; rgbdt calibrate " + ForShell(directory_.string()) + " takes the " +
         std::to_string(views) + " views that are on disk";
}

// Why no view is to be taken now; empty: there is room. A script that waits asks once a second.
std::string SessionNode::NoRoom() {
  if (by_request_) WriteToDisk();
  if (by_request_ || no_room_.empty() || room_asked_.IsDue(now_)) {
    const bool named = !view_.empty() && !view_taken_;  // by its pose
    no_room_ = unwritten_.WhyNoRoom(named ? view_ : ViewName(view_number_ + 1));
  }
  return no_room_;
}

}  // namespace rgbdt
