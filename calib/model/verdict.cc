#include "calib/model/verdict.h"

#include "calib/model/errors.h"

namespace rgbdt {

const char* NameOf(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kUsable:
      return "usable";
    case Grade::kDoubtful:
      return "doubtful";
    case Grade::kNone:
      return "none";
    case Grade::kBad:
      break;
  }
  return "bad";
}

const char* WordsOf(Grade grade) {
  if (grade == Grade::kBad) return "do not use";
  return grade == Grade::kNone ? "not judged yet" : NameOf(grade);
}

Grade GradeNamed(const std::string& name) {
  for (const Grade grade :
       {Grade::kGood, Grade::kUsable, Grade::kDoubtful, Grade::kNone, Grade::kBad}) {
    if (name == NameOf(grade)) return grade;
  }
  throw InputError("verdict: grade is \"" + name +
                   "\"; expected good, usable, doubtful, none or bad");
}

}  // namespace rgbdt
