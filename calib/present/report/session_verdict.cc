#include "calib/present/report/session_verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr int kEnoughViews = 8;
constexpr char kNoneYet[] = "No calibration yet";

std::string ViewsToTake(int found) {
  const std::string so_far =
      "The board was found in " + Count(static_cast<std::size_t>(found), "view");
  if (found >= kEnoughViews) return so_far + ": enough to solve.";
  return so_far + "; take " + std::to_string(kEnoughViews - found) +
         " more at least, at other distances and tilts and all over the images.";
}

bool WasJudged(const CameraReport* report) {
  return report != nullptr &&
         (report->edge_rms_px.train || report->edge_rms_px.heldout || report->scene);
}

// There were enough views, and the solve failed.
bool HasFailed(const JudgedCamera& camera) {
  if (camera.report == nullptr || camera.calibrated) return false;
  const CameraReport& report = *camera.report;
  const std::size_t views = report.used.size() + report.heldout.size() + report.rejected.size();
  return views >= std::size_t{kEnoughViews} && !report.calibration.solved() &&
         !report.calibration.detail.empty();
}

// The worst over all cameras [px]; nothing where one has none.
std::optional<double> ProjectionUncertainty(const std::vector<JudgedCamera>& cameras) {
  double worst = 0;
  for (const JudgedCamera& camera : cameras) {
    const ColouringSigma* at = camera.report == nullptr ? nullptr : JudgedColouring(*camera.report);
    if (at == nullptr) return std::nullopt;
    worst = std::max(worst, at->worst_px);
  }
  return worst;
}

std::string AllGood(const std::vector<JudgedCamera>& cameras) {
  const std::string who = cameras.size() == 1 ? "Camera " + cameras.front().camera + " is"
                          : cameras.size() == 2
                              ? "Both cameras are"
                              : "All " + std::to_string(cameras.size()) + " cameras are";
  const auto within = ProjectionUncertainty(cameras);
  if (!within) return who + " calibrated";
  return who + " calibrated; projection uncertainty at " + Number(kJudgedAtM, 0) + " m: up to " +
         Number(*within, *within < 0.1 ? 2 : 1) + " px (1 sigma)";
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

std::string Clause(Grade grade, const std::vector<std::string>& names) {
  if (grade == Grade::kBad) return "do not use the calibration of " + Listed(names);
  if (grade == Grade::kNone) return "no calibration yet of " + Listed(names);
  if (grade == Grade::kDoubtful) return "doubtful: " + Listed(names);
  if (grade == Grade::kUsable) return "usable: " + Listed(names);
  return Listed(names) + (names.size() == 1 ? " is" : " are") + " calibrated";
}

// The worst first. It never begins with a name: those stay as they are written.
std::string Mixed(const std::vector<JudgedCamera>& cameras, const std::vector<Verdict>& verdicts) {
  std::string headline;
  const auto add = [&](const std::string& clause) {
    headline += (headline.empty() ? "" : "; ") + clause;
  };
  for (const Grade grade :
       {Grade::kBad, Grade::kNone, Grade::kDoubtful, Grade::kUsable, Grade::kGood}) {
    std::vector<std::string> names;
    std::vector<std::string> unjudged;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      if (verdicts[i].grade != grade) continue;
      const bool so_far = grade == Grade::kNone && cameras[i].calibrated;
      (so_far ? unjudged : names).push_back(cameras[i].camera);
    }
    if (!names.empty()) add(Clause(grade, names));
    if (!unjudged.empty()) add("calibrated so far, not judged yet: " + Listed(unjudged));
  }
  headline.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(headline.front())));
  return headline;
}

Cell JudgedSigmas(const std::optional<double>& rms) {
  if (!rms) return {"not judged yet"};
  if (*rms > kMostWhitened) return {"less exact than stated", Grade::kDoubtful};
  if (*rms < kLeastWhitened) return {"more exact than stated", Grade::kUsable};
  return {"as expected", Grade::kGood};
}

}  // namespace

Verdict VerdictOf(const JudgedCamera& camera, const std::optional<NextView>& next_view) {
  if (WasJudged(camera.report) || HasFailed(camera)) return Judge(*camera.report, next_view);
  if (camera.calibrated) return {Grade::kNone, "Calibrated, but not judged on views yet", {}};
  Verdict words{Grade::kNone, kNoneYet, {ViewsToTake(camera.views_found)}};
  if (camera.report != nullptr && !camera.report->calibration.detail.empty()) {
    words.reasons.push_back("Status of the solve: " + camera.report->calibration.StatusText());
  }
  return words;
}

Verdict VerdictOfAll(const std::vector<JudgedCamera>& cameras,
                     const std::optional<NextView>& next_view) {
  Verdict all{Grade::kNone, kNoneYet, {}};
  if (cameras.empty()) {
    all.reasons.emplace_back("No rig is known yet.");
    return all;
  }
  std::vector<Verdict> verdicts;
  all.grade = Grade::kGood;
  for (const JudgedCamera& camera : cameras) {
    const Verdict& one = verdicts.emplace_back(VerdictOf(camera, next_view));
    all.grade = std::max(all.grade, one.grade);
    if (one.grade == Grade::kGood) continue;
    for (const std::string& reason : one.reasons) {
      all.reasons.push_back(camera.camera + ": " + reason);
    }
  }
  const bool none_judged = std::all_of(cameras.begin(), cameras.end(), [](const JudgedCamera& c) {
    return !c.calibrated && !WasJudged(c.report) && !HasFailed(c);
  });
  if (all.grade == Grade::kGood) {
    all.headline = AllGood(cameras);
  } else if (!none_judged) {
    all.headline = Mixed(cameras, verdicts);
  }
  return all;
}

Table HeldoutTable(const std::vector<JudgedCamera>& cameras) {
  Table table{"Held-out views",
              {"RMS distance of the cloud's board edge from the board's outline, on views that the "
               "solver never saw. 1 sigma is expected."},
              {"Camera", "Distance", "In sigmas", "Verdict"},
              {}};
  for (const JudgedCamera& camera : cameras) {
    std::optional<double> px, sigmas;
    if (camera.report != nullptr) {
      px = camera.report->edge_rms_px.heldout;
      sigmas = camera.report->edge_rms_whitened.heldout;
    }
    table.rows.push_back({{camera.camera},
                          {WithUnit(px, 2, "px")},
                          {WithUnit(sigmas, 2, "σ")},
                          JudgedSigmas(sigmas)});
  }
  if (table.rows.empty()) table.notes.clear();
  return table;
}

}  // namespace rgbdt
