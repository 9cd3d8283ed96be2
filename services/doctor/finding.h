#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// What `rgbdt doctor` has to say of one thing.
struct Finding {
  enum class Level { kOk, kWarning, kProblem };
  Level level = Level::kOk;
  std::string check;  ///< what was looked at: "receive buffer", "camera rgb"
  std::string what;   ///< in plain words, with the values
  std::string fix;    ///< the command, or what to do; empty: nothing
};
using Findings = std::vector<Finding>;

Finding Ok(std::string check, std::string what);
Finding Warning(std::string check, std::string what, std::string fix = "");
Finding Problem(std::string check, std::string what, std::string fix = "");

void Append(Findings findings, Findings* to);

bool HasProblem(const Findings& findings);

/// For a terminal: what is well first and problems last, where the eye is; then their number.
std::string FindingsText(Findings findings);

}  // namespace rgbdt
