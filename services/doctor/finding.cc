#include "services/doctor/finding.h"

#include <algorithm>
#include <iterator>

namespace rgbdt {
namespace {

const char* Word(Finding::Level level) {
  switch (level) {
    case Finding::Level::kOk:
      return "ok       ";
    case Finding::Level::kWarning:
      return "WARNING  ";
    default:
      return "PROBLEM  ";
  }
}

std::string Count(const Findings& findings, Finding::Level level, const std::string& noun) {
  const auto count = std::count_if(findings.begin(), findings.end(),
                                   [&](const Finding& finding) { return finding.level == level; });
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

Finding Ok(std::string check, std::string what) {
  return {Finding::Level::kOk, std::move(check), std::move(what), ""};
}

Finding Warning(std::string check, std::string what, std::string fix) {
  return {Finding::Level::kWarning, std::move(check), std::move(what), std::move(fix)};
}

Finding Problem(std::string check, std::string what, std::string fix) {
  return {Finding::Level::kProblem, std::move(check), std::move(what), std::move(fix)};
}

void Append(Findings findings, Findings* to) {
  std::move(findings.begin(), findings.end(), std::back_inserter(*to));
}

bool HasProblem(const Findings& findings) {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.level == Finding::Level::kProblem;
  });
}

std::string FindingsText(Findings findings) {
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.level < b.level; });
  std::string text;
  for (const Finding& finding : findings) {
    text += Word(finding.level) + finding.check + ": " + finding.what + "\n";
    if (!finding.fix.empty()) text += "  fix: " + finding.fix + "\n";
  }
  return text + Count(findings, Finding::Level::kProblem, "problem") + ", " +
         Count(findings, Finding::Level::kWarning, "warning") + "\n";
}

}  // namespace rgbdt
