#include "calib/present/report/verdict_words.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "calib/present/report/html.h"
#include "calib/present/report/internal/verdict.h"

namespace rgbdt::viewer {
namespace {

constexpr int kEnoughViews = 8;
constexpr double kColoursAtM = 5;
constexpr char kNoneYet[] = "No calibration yet";

// Best first: of several cameras the last of these is what counts.
const std::vector<std::string>& Grades() {
  static const std::vector<std::string> grades = {"good", "caution", "none", "bad"};
  return grades;
}

std::string NameOf(Verdict::Grade grade) {
  switch (grade) {
    case Verdict::Grade::kGood:
      return "good";
    case Verdict::Grade::kCaution:
      return "caution";
    case Verdict::Grade::kBad:
      break;
  }
  return "bad";
}

std::string ViewsToTake(int found) {
  const std::string so_far =
      "The board was found in " + std::to_string(found) + (found == 1 ? " view" : " views");
  if (found >= kEnoughViews) return so_far + ": enough to solve.";
  return so_far + "; take " + std::to_string(kEnoughViews - found) +
         " more at least, at other distances and tilts and all over the images.";
}

bool WasJudged(const CameraReport* report) {
  return report != nullptr && (report->edge_rms_px.train || report->edge_rms_px.heldout);
}

// Worst 1 sigma of a colour at kColoursAtM over all cameras [px]; nothing where one has none.
std::optional<double> ColoursWithin(const std::vector<JudgedCamera>& cameras) {
  double worst = 0;
  for (const JudgedCamera& camera : cameras) {
    if (camera.report == nullptr || !camera.report->sigma) return std::nullopt;
    const auto& colouring = camera.report->sigma->colouring;
    const auto at = std::find_if(colouring.begin(), colouring.end(), [](const ColouringSigma& s) {
      return s.distance_m == kColoursAtM && std::isfinite(s.worst_px);
    });
    if (at == colouring.end()) return std::nullopt;
    worst = std::max(worst, at->worst_px);
  }
  return worst;
}

std::string AllGood(const std::vector<JudgedCamera>& cameras) {
  const std::string who = cameras.size() == 1 ? "Camera " + cameras.front().camera + " is"
                          : cameras.size() == 2
                              ? "Both cameras are"
                              : "All " + std::to_string(cameras.size()) + " cameras are";
  const auto within = ColoursWithin(cameras);
  if (!within) return who + " calibrated";
  return who + " calibrated: colours sit within " + html::Number(*within, *within < 0.1 ? 2 : 1) +
         " px at " + html::Number(kColoursAtM, 0) + " m (1 sigma)";
}

// "a", "a and b", "a, b and c"
std::string Listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " and " : ", ";
    out += names[i];
  }
  return out;
}

std::string Clause(const std::string& grade, const std::vector<std::string>& names) {
  if (grade == "bad") return "do not use the calibration of " + Listed(names);
  if (grade == "none") return "no calibration yet of " + Listed(names);
  if (grade == "caution") return "take care with " + Listed(names);
  return Listed(names) + (names.size() == 1 ? " is" : " are") + " calibrated";
}

// The worst first. It never begins with a name: those stay as they are written.
std::string Mixed(const std::vector<JudgedCamera>& cameras,
                  const std::vector<VerdictWords>& verdicts) {
  std::string headline;
  const auto add = [&](const std::string& clause) {
    headline += (headline.empty() ? "" : "; ") + clause;
  };
  for (auto grade = Grades().rbegin(); grade != Grades().rend(); ++grade) {
    std::vector<std::string> names;
    std::vector<std::string> unjudged;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      if (verdicts[i].grade != *grade) continue;
      const bool so_far = *grade == "none" && cameras[i].calibrated;
      (so_far ? unjudged : names).push_back(cameras[i].camera);
    }
    if (!names.empty()) add(Clause(*grade, names));
    if (!unjudged.empty()) add("calibrated so far, not judged yet: " + Listed(unjudged));
  }
  headline.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(headline.front())));
  return headline;
}

std::size_t RankOf(const std::string& grade) {
  return static_cast<std::size_t>(std::find(Grades().begin(), Grades().end(), grade) -
                                  Grades().begin());
}

}  // namespace

VerdictWords VerdictOf(const JudgedCamera& camera, const std::optional<NextView>& next_view) {
  if (WasJudged(camera.report)) {
    const Verdict verdict = Judge(*camera.report, next_view);
    return {NameOf(verdict.grade), verdict.headline, verdict.reasons};
  }
  if (camera.calibrated) return {"none", "Calibrated, but not judged on views yet", {}};
  VerdictWords words{"none", kNoneYet, {ViewsToTake(camera.views_found)}};
  if (camera.report != nullptr && !camera.report->calibration.detail.empty()) {
    words.reasons.push_back("The solve says: " + camera.report->calibration.StatusText());
  }
  return words;
}

VerdictWords VerdictOfAll(const std::vector<JudgedCamera>& cameras,
                          const std::optional<NextView>& next_view) {
  VerdictWords all{"none", kNoneYet, {}};
  if (cameras.empty()) {
    all.reasons.emplace_back("No rig is known yet.");
    return all;
  }
  std::vector<VerdictWords> verdicts;
  all.grade = "good";
  for (const JudgedCamera& camera : cameras) {
    const VerdictWords& one = verdicts.emplace_back(VerdictOf(camera, next_view));
    if (RankOf(one.grade) > RankOf(all.grade)) all.grade = one.grade;
    if (one.grade == "good") continue;
    for (const std::string& reason : one.reasons) {
      all.reasons.push_back(camera.camera + ": " + reason);
    }
  }
  const bool none_judged = std::all_of(cameras.begin(), cameras.end(), [](const JudgedCamera& c) {
    return !c.calibrated && !WasJudged(c.report);
  });
  if (all.grade == "good") {
    all.headline = AllGood(cameras);
  } else if (!none_judged) {
    all.headline = Mixed(cameras, verdicts);
  }
  return all;
}

}  // namespace rgbdt::viewer
