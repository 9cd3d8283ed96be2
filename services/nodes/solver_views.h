#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "calib/model/calibration.h"
#include "services/messages/message.h"

namespace rgbdt {

/// What the solver must have of a session: each view's newest DETECTION and the newest
/// LEFT_OUT_VIEWS, as they came. A solver that was started anew has lost them; that shows in the
/// number of views in its STATUS, and in its REPORT.
class SolverViews {
 public:
  static constexpr int kMaxTries = 3;  ///< in a row, until it has all

  /// A new session begins.
  void Clear() { *this = {}; }
  void Add(const ViewDetection& detection) { detections_[detection.view] = detection; }
  /// The view is taken again.
  void Drop(const std::string& view) { detections_.erase(view); }
  /// Null: none came.
  const ViewDetection* Find(const std::string& view) const {
    const auto found = detections_.find(view);
    return found == detections_.end() ? nullptr : &found->second;
  }
  void Set(const LeftOutViews& left_out) { left_out_ = left_out; }
  /// The view was captured: no result is complete without it.
  void Require(const std::string& view) { required_.insert(view); }

  /// Whether the solver, by its STATUS, lacks views that were there at its STATUS before, and does
  /// not take more of them.
  bool LostBy(const Status& solver);
  /// Captured views that the report was made without, in words; empty: none, but for those that a
  /// person left out.
  std::string MissingIn(const std::optional<Report>& report) const;
  /// All of it once more; nothing where there is nothing, or where kMaxTries were of no use.
  Messages Again();

 private:
  std::map<std::string, ViewDetection> detections_;
  std::optional<LeftOutViews> left_out_;
  std::set<std::string> required_;
  std::size_t due_ = 0;      // views that the next STATUS must count
  std::size_t counted_ = 0;  // by the STATUS before
  int tries_ = 0;
};

}  // namespace rgbdt
