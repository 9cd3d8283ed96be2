#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What a session has to write of its views. What cannot be written, as the disk is full or the
/// folder may not be written, is kept in memory until it can: no view is lost for it. A view comes
/// before its detection, and each is on disk whole or not at all.
class UnwrittenViews {
 public:
  static constexpr Utime kRetry = 3 * kMicrosecondsPerSecond;

  UnwrittenViews(std::filesystem::path directory, const Rig& rig);

  /// To be written; in place of what is kept of the same view.
  void Add(View view);
  void Add(const ViewDetection& detection) { detections_[detection.view] = detection; }
  void Add(const LeftOutViews& left_out) { left_out_ = left_out; }
  /// The view is taken again.
  void Drop(const std::string& view);
  /// Null: it is not kept.
  const View* Find(const std::string& view) const;

  /// Tries to write all, at `now` [us, a clock that only grows].
  void Write(Utime now);
  bool IsDue(Utime now) const { return !empty() && now - tried_ >= kRetry; }
  bool empty() const { return views_.empty() && detections_.empty() && !left_out_; }
  /// The newest try was in vain.
  bool failed() const { return !why_.empty(); }
  /// How many views are kept.
  std::size_t views() const { return views_.size(); }
  /// What is kept and why, for a person; empty: nothing is.
  std::string Trouble() const;
  /// The process ends: what is lost with it and why; empty: nothing is.
  std::string Lost() const;

  /// Why one more view of that name could not be written, for a person; empty: it could.
  std::string WhyNoRoom(const std::string& view) const;

 private:
  std::string What() const;

  std::filesystem::path directory_;
  std::uintmax_t view_bytes_ = 0;  // of the largest one so far
  std::map<std::string, View> views_;
  std::map<std::string, ViewDetection> detections_;
  std::optional<LeftOutViews> left_out_;
  Utime tried_ = 0;
  std::string why_;  // it could not be written
};

}  // namespace rgbdt
