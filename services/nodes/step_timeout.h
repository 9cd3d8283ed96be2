#pragma once

#include <map>
#include <string>

#include "calib/model/time.h"

namespace rgbdt {

/// When a step of a session has taken too long. Only silence does: each new progress (a larger
/// fraction than its sender told before in this step) gives the step its time once more. All in
/// all a step has kMostTimes its time, so that one that creeps on forever ends, too.
class StepTimeout {
 public:
  static constexpr int kMostTimes = 10;
  static constexpr std::size_t kMostSenders = 100;  ///< whose progress counts

  /// A step begins at `now` [us, the clock of Advance] and may take `timeout_s` in silence.
  void Begin(Utime now, double timeout_s);
  /// The same step is asked once more: it has its time again, and progress counts from 0.
  void AskedAgain(Utime now);
  /// Progress counts from the next WhyOver on: what waited while this process was held up is as
  /// good as new. What is no fraction from 0 to 1 is nothing.
  void OnProgress(const std::string& sender, double fraction);
  /// Empty, or why the step is over, for a person.
  std::string WhyOver(Utime now);

  Utime began() const { return began_; }  ///< the step, or its newest asking [us]

 private:
  std::string NewestProgress() const;

  double timeout_s_ = 0;
  Utime first_ = 0, began_ = 0, alive_ = 0;
  bool progressed_ = false;  // since WhyOver was asked last
  std::map<std::string, double> fractions_;
  std::string newest_sender_;  // empty: no progress since it was asked
};

}  // namespace rgbdt
