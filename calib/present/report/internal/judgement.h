#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt {

/// What is said for and against a result. What speaks against it comes first, in the order in which
/// it was said.
class Judgement {
 public:
  void AddReason(const std::string& sentence) { others_.push_back(sentence); }
  void Usable(const std::string& sentence) { Say(Grade::kUsable, sentence); }
  void Doubtful(const std::string& sentence) { Say(Grade::kDoubtful, sentence); }
  void Bad(const std::string& sentence) { Say(Grade::kBad, sentence); }
  Grade grade() const { return grade_; }
  /// Whether a reason not to use it has these words.
  bool SaysBad(const std::string& words) const {
    const auto says = [&](const auto& said) {
      return said.first == Grade::kBad && said.second.find(words) != std::string::npos;
    };
    return std::any_of(causes_.begin(), causes_.end(), says) ||
           std::any_of(against_.begin(), against_.end(), says);
  }
  /// Something else has to be corrected first: more views are no advice.
  void NoMoreViews() { more_views_ = false; }
  bool more_views() const { return more_views_; }
  /// Before all else of this grade.
  void Cause(Grade grade, const std::string& sentence) {
    grade_ = std::max(grade_, grade);
    causes_.emplace_back(grade, sentence);
  }
  /// Nothing else matters beside it.
  void Headline(const std::string& headline) { headline_ = headline; }
  /// What is worst comes first.
  Verdict Finish() {
    against_.insert(against_.begin(), causes_.begin(), causes_.end());
    std::stable_sort(against_.begin(), against_.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    Verdict verdict{grade_, headline_, {}};
    for (const auto& [grade, sentence] : against_) verdict.reasons.push_back(sentence);
    verdict.reasons.insert(verdict.reasons.end(), others_.begin(), others_.end());
    if (!headline_.empty()) return verdict;
    verdict.headline = grade_ == Grade::kGood       ? "Good: no sign that it is wrong."
                       : grade_ == Grade::kUsable   ? "Usable."
                       : grade_ == Grade::kDoubtful ? "Doubtful: something does not fit together."
                                                    : "Do not use it.";
    return verdict;
  }

 private:
  void Say(Grade grade, const std::string& sentence) {
    grade_ = std::max(grade_, grade);
    against_.emplace_back(grade, sentence);
  }

  Grade grade_ = Grade::kGood;
  bool more_views_ = true;
  std::string headline_;
  std::vector<std::pair<Grade, std::string>> causes_, against_;
  std::vector<std::string> others_;  // reasons that are no alarm
};

}  // namespace rgbdt
