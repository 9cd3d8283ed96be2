#include "services/nodes/solver_views.h"

#include <algorithm>

#include "calib/model/said_again.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

std::size_t ViewsOf(const Status& status) {
  return static_cast<std::size_t>(std::max<std::int64_t>(CounterOf(status, "views"), 0));
}

}  // namespace

// A STATUS may have left before the newest detection came: what counts is what was there one STATUS
// earlier; and one that still takes what it was sent counts more each time.
bool SolverViews::LostBy(const Status& solver) {
  const std::size_t views = ViewsOf(solver);
  const bool lost = solver.ready && views < due_ && views <= counted_;
  if (views >= detections_.size()) tries_ = 0;
  due_ = detections_.size();
  counted_ = views;
  return lost;
}

std::string SolverViews::MissingIn(const std::optional<Report>& report) const {
  std::set<std::string> missing = required_;
  if (report) {
    for (const DetectedView& view : report->detections) missing.erase(view.view);
  }
  if (left_out_) {
    for (const std::string& view : left_out_->views) missing.erase(view);
  }
  std::string names;
  for (const std::string& view : missing) names += (names.empty() ? "" : ", ") + view;
  return names;
}

// First the detections: a solver refuses to leave out all that it has.
Messages SolverViews::Again() {
  if (detections_.empty() || tries_ >= kMaxTries) return {};
  ++tries_;
  Messages again;
  for (const auto& [view, detection] : detections_) again.emplace_back(detection);
  if (left_out_) again.emplace_back(*left_out_);
  for (Message& message : again) SetSeq(kSaidAgain, &message);
  return again;
}

}  // namespace rgbdt
