#include "services/nodes/step_timeout.h"

#include <cmath>

namespace rgbdt {
namespace {

std::string InSeconds(double seconds) { return std::to_string(std::lround(seconds)) + " s"; }

}  // namespace

void StepTimeout::Begin(Utime now, double timeout_s) {
  timeout_s_ = timeout_s;
  first_ = now;
  AskedAgain(now);
}

void StepTimeout::AskedAgain(Utime now) {
  began_ = alive_ = now;
  progressed_ = false;
  fractions_.clear();
  newest_sender_.clear();
}

void StepTimeout::OnProgress(const std::string& sender, double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) return;
  const auto known = fractions_.find(sender);
  if (known == fractions_.end() ? fractions_.size() >= kMostSenders : fraction <= known->second) {
    return;
  }
  fractions_[sender] = fraction;
  newest_sender_ = sender;
  progressed_ = true;
}

std::string StepTimeout::WhyOver(Utime now) {
  if (progressed_) alive_ = now;
  progressed_ = false;
  if (ToSeconds(now - first_) > kMostTimes * timeout_s_) {
    return "no answer in " + InSeconds(kMostTimes * timeout_s_) +
           (newest_sender_.empty() ? ""
                                   : ", though " + NewestProgress() +
                                         "; give the step a longer timeout_s in the script");
  }
  if (ToSeconds(now - alive_) <= timeout_s_) return {};
  if (newest_sender_.empty()) return "no answer in " + InSeconds(timeout_s_);
  return "no answer and no progress in " + InSeconds(timeout_s_) + ", since " + NewestProgress();
}

std::string StepTimeout::NewestProgress() const {
  const double percent = 100 * fractions_.at(newest_sender_);
  return newest_sender_ + " was at " + std::to_string(std::lround(percent)) + "%";
}

}  // namespace rgbdt
