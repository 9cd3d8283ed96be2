#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// How far a calibration is to be relied on, from good to bad: of several cameras the worst counts.
enum class Grade {
  kGood,      ///< no sign that it is wrong, and as exact as asked
  kUsable,    ///< no sign that it is wrong; it could be more exact, or better checked
  kDoubtful,  ///< something does not fit together: find out what before relying on it
  kNone,      ///< not judged yet
  kBad,       ///< not to be used
};

/// "good", "usable", "doubtful", "none" or "bad": the word in files and frames, the class in HTML.
const char* NameOf(Grade grade);

/// The same for a person: "do not use" where it is bad, "not judged yet" where it was not.
const char* WordsOf(Grade grade);

/// How `detail` of a calibration begins that is doubtful; the first reason follows.
inline constexpr const char* kDoubtfulDetail = "doubtful: ";

/// Throws InputError for a word that NameOf does not give.
Grade GradeNamed(const std::string& name);

struct Verdict {
  Grade grade = Grade::kGood;
  std::string headline;
  /// Sentences; the figures are in them. What speaks against the result comes first.
  std::vector<std::string> reasons;
};

}  // namespace rgbdt
