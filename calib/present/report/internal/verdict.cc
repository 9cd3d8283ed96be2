#include "calib/present/report/internal/verdict.h"

#include <algorithm>
#include <cmath>

#include "calib/present/report/html.h"

namespace rgbdt {
namespace {

using Grade = Verdict::Grade;

constexpr std::size_t kFewViews = 5;
// Held-out views always fit a little worse; beyond this the solve has learnt its views by heart.
constexpr double kWorse = 1.5, kWorsePx = 0.5;
constexpr double kElsewhereDeg = 0.5, kElsewhereMm = 50;
constexpr double kClearlyWorse = 1.2;
constexpr double kJudgedAtM = 5, kUnsurePx = 1;
// Of the held-out crossings' RMS in their sigmas: beyond these the sigmas are not what was stated.
constexpr double kLeastWhitened = 0.7, kMostWhitened = 1.4;

class Judgement {
 public:
  void Say(const std::string& sentence) { verdict_.reasons.push_back(sentence); }
  void Caution(const std::string& sentence) {
    verdict_.grade = std::max(verdict_.grade, Grade::kCaution);
    Say(sentence);
  }
  void Bad(const std::string& sentence) {
    verdict_.grade = Grade::kBad;
    Say(sentence);
  }
  /// Nothing else matters beside it.
  void Headline(const std::string& headline) { verdict_.headline = headline; }
  Verdict Finish() {
    if (!verdict_.headline.empty()) return verdict_;
    verdict_.headline = verdict_.grade == Grade::kGood ? "Consistent: no sign that it is wrong."
                        : verdict_.grade == Grade::kCaution ? "Take care before using it."
                                                            : "Do not use it.";
    return verdict_;
  }

 private:
  Verdict verdict_;
};

void JudgeFit(const CameraReport& camera, Judgement* judgement) {
  const TrainHeldout& rms = camera.edge_rms_px;
  if (!rms.heldout) {
    judgement->Caution("It was not checked: no view that was kept from the solver could be used.");
    return;
  }
  const std::string held =
      "On views that the solver never saw, the board's outline is met within " +
      html::Number(*rms.heldout, 2) + " px RMS";
  if (!rms.train) {
    judgement->Say(held + ".");
  } else if (*rms.heldout > kWorse * *rms.train + kWorsePx) {
    judgement->Caution(held + ", clearly worse than the " + html::Number(*rms.train, 2) +
                       " px on the views used: take more views, at other distances and tilts.");
  } else {
    judgement->Say(held + ", as well as on the views used (" + html::Number(*rms.train, 2) +
                   " px).");
  }
}

std::string Count(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Another start that ended elsewhere and fits clearly worse is only a bad start.
bool FitsWorse(const StartResult& start, const CameraReport& camera) {
  const std::optional<double>& result = camera.distance_transform_px.train;
  return start.distance_transform_px && result &&
         *start.distance_transform_px > kClearlyWorse * *result;
}

void JudgeStarts(const CameraReport& camera, Judgement* judgement) {
  PoseError worst;
  std::size_t rivals = 0, stuck = 0;
  for (const StartResult& start : camera.other_starts) {
    const PoseError& error = start.from_result;
    if (error.rotation_deg <= kElsewhereDeg && error.translation_mm <= kElsewhereMm) continue;
    ++(FitsWorse(start, camera) ? stuck : rivals);
    worst.rotation_deg = std::max(worst.rotation_deg, error.rotation_deg);
    worst.translation_mm = std::max(worst.translation_mm, error.translation_mm);
  }
  if (camera.other_starts.empty()) return;
  const std::string of = " of " + Count(camera.other_starts.size(), "other start");
  const std::string away = "up to " + html::Number(worst.rotation_deg, 2) + "° and " +
                           html::Number(worst.translation_mm, 0) + " mm away";
  if (rivals > 0) {
    judgement->Caution(std::to_string(rivals) + of + " ended elsewhere, " + away +
                       ", and fits about as well: the result depends on the start.");
  } else if (stuck > 0) {
    judgement->Say(std::to_string(stuck) + of + " ended elsewhere, " + away +
                   ", and fits worse: the first guess has to be nearer than that.");
  } else {
    judgement->Say("From " + Count(camera.other_starts.size(), "other start") +
                   " it comes to the same result.");
  }
}

void JudgeStatus(const CameraCalibration& calibration, const std::optional<NextView>& next_view,
                 Judgement* judgement) {
  const std::string& detail = calibration.detail;
  switch (calibration.status) {
    case SolveStatus::kUndetermined:
    case SolveStatus::kDegenerate:
      judgement->Headline("Do not use it: the pose cannot be told from these views.");
      judgement->Bad("The solve says: " + calibration.StatusText());
      if (next_view) judgement->Say("Next: " + next_view->words);
      break;
    case SolveStatus::kNotSolved:
      judgement->Bad("There was no solve" + (detail.empty() ? "." : ": " + detail));
      break;
    case SolveStatus::kNotConverged:
      judgement->Bad("The solve did not converge" + (detail.empty() ? "." : ": " + detail));
      break;
    case SolveStatus::kFirstGuessKept:
      judgement->Say("The solve says: " + calibration.StatusText());
      break;
    case SolveStatus::kConverged:
      break;
  }
}

void JudgeColouring(const PoseSigma& sigma, Judgement* judgement) {
  for (const ColouringSigma& at : sigma.colouring) {
    if (std::abs(at.distance_m - kJudgedAtM) > 1e-6 || !std::isfinite(at.worst_px)) continue;
    const std::string far = "1 sigma of where the colour of a point " +
                            html::Number(kJudgedAtM, 0) + " m away is taken from is " +
                            html::Number(at.worst_px, 2) + " px where it is worst in the image";
    if (at.worst_px > kUnsurePx) {
      judgement->Caution(far + ", more than " + html::Number(kUnsurePx, 0) +
                         " px: take more views in that part of the image, some about as far away.");
    } else {
      judgement->Say(far + ".");
    }
  }
}

void JudgeHalves(const Halves& halves, Judgement* judgement) {
  const std::string differ = "Two halves of the views, each solved by itself, differ by " +
                             html::PoseErrorText(halves.difference);
  if (halves.chi2 > kUnlikelyChi2) {
    judgement->Caution(differ + ", more than their sigmas allow (chi-square " +
                       html::Number(halves.chi2, 1) + ", by chance above " +
                       html::Number(kUnlikelyChi2, 1) +
                       " once in a thousand times): the stated sigma is not to be believed.");
  } else {
    judgement->Say(differ + (std::isnan(halves.chi2) ? "." : ", no more than their sigmas allow."));
  }
}

void JudgeWhitened(const std::optional<double>& rms, Judgement* judgement) {
  if (!rms || (*rms >= kLeastWhitened && *rms <= kMostWhitened)) return;
  judgement->Caution("On the views held out the beams miss the board's edge by " +
                     html::Number(*rms, 2) + " of their sigmas (RMS; expected: 1): they are " +
                     (*rms > 1 ? "less" : "more") +
                     " exact than stated, and the stated sigma is not to be believed.");
}

}  // namespace

Verdict Judge(const CameraReport& camera, const std::optional<NextView>& next_view) {
  Judgement judgement;
  JudgeStatus(camera.calibration, next_view, &judgement);
  JudgeFit(camera, &judgement);
  JudgeWhitened(camera.edge_rms_whitened.heldout, &judgement);
  if (camera.halves) JudgeHalves(*camera.halves, &judgement);
  if (camera.sigma) JudgeColouring(*camera.sigma, &judgement);
  JudgeStarts(camera, &judgement);
  if (camera.used.size() < kFewViews) {
    judgement.Caution("Views used: only " + std::to_string(camera.used.size()) + "; take " +
                      std::to_string(kFewViews) + " or more.");
  }
  if (!camera.rejected.empty()) {
    judgement.Say("Rejected: " + Count(camera.rejected.size(), "view") +
                  "; why stands in the table of views.");
  }
  if (camera.truth_error) {
    judgement.Say("The truth is known here: the result is " +
                  html::Number(camera.truth_error->rotation_deg, 3) + "° and " +
                  html::Number(camera.truth_error->translation_mm, 1) + " mm away from it.");
  }
  return judgement.Finish();
}

}  // namespace rgbdt
