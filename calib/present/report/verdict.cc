#include "calib/present/report/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/present/report/internal/judge_views.h"
#include "calib/present/report/internal/judgement.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr std::size_t kFewViews = 5;
constexpr double kElsewhereDeg = 0.5, kElsewhereMm = 50;
constexpr double kClearlyWorse = 1.2;
constexpr double kUncertainPx = 1;
// Recorded sessions of right rig files reach 12 px, of a plain board before a long lens 36; beyond
// three times that something that is not in the views, a lens most often, is wrong, however large
// the stated sigma is.
constexpr double kMostUncertainPx = 100;
// Of what was given wrong, in sigmas of the pose that it moves.
constexpr double kMovesLittle = 1, kMovesMuch = 4;
// What is less likely than this is not named as a cause.
constexpr double kLeastNamedSigmas = 1, kLeastNamedWhereUsable = 2.5;
constexpr std::size_t kMostNamed = 2;

std::string Moves(const Cause& cause) {
  const std::string sigmas = cause.moves_sigma ? Number(*cause.moves_sigma, 1) : "0.0";
  return sigmas == "0.0" ? "" : " Corrected, it moves the result by " + sigmas + " sigma.";
}

// May be chance, but for what hangs on it: the pose is as sure as stated only if what was given is.
bool IsFeared(const Cause& cause) {
  return cause.Sigmas() < kGivenWrongSigmas && cause.Sigmas() >= kLeastNamedWhereUsable &&
         cause.moves_sigma && *cause.moves_sigma > kMovesMuch;
}

// What was given wrong, by how much the result moves where it is put right.
Grade GradeOf(const Cause& cause) {
  if (!cause.moves_sigma) return Grade::kDoubtful;
  return *cause.moves_sigma > kMovesMuch     ? Grade::kBad
         : *cause.moves_sigma > kMovesLittle ? Grade::kDoubtful
                                             : Grade::kUsable;
}

// Those to be named, what counts most first. Where something else says that all is not well, also
// what may be behind it.
std::vector<const Cause*> CausesToName(const CameraReport& camera, Grade grade) {
  std::vector<const Cause*> named;
  const auto wrong = [](const Cause& cause) { return cause.Sigmas() >= kGivenWrongSigmas; };
  const double least = grade >= Grade::kDoubtful ? kLeastNamedSigmas
                       : ViewsDisagree(camera)   ? kLeastNamedWhereUsable
                                                 : kGivenWrongSigmas;
  for (const Cause& cause : camera.causes) {
    if (cause.Sigmas() >= least || IsFeared(cause)) named.push_back(&cause);
  }
  const auto rank = [&](const Cause* cause) {
    return wrong(*cause)      ? std::pair(GradeOf(*cause), 2)
           : IsFeared(*cause) ? std::pair(Grade::kDoubtful, 1)
                              : std::pair(Grade::kGood, 0);
  };
  std::stable_sort(named.begin(), named.end(),
                   [&](const Cause* a, const Cause* b) { return rank(a) > rank(b); });
  if (named.size() > kMostNamed) named.resize(kMostNamed);
  return named;
}

// What a cause alone makes of the result: kGood of one that is only named.
Grade AloneGradeOf(const CameraReport& camera, const Cause& cause) {
  // Where it left no pose, nothing tells how far that would move.
  const bool solved = camera.calibration.status != SolveStatus::kNotSolved;
  if (cause.Sigmas() >= kGivenWrongSigmas) return solved ? GradeOf(cause) : Grade::kBad;
  return IsFeared(cause) ? Grade::kDoubtful : Grade::kGood;
}

// The views contradict what was given, so far that the result is not to be used.
bool IsGivenWrong(const CameraReport& camera) {
  return !camera.contradiction.empty() ||
         std::any_of(camera.causes.begin(), camera.causes.end(), [&](const Cause& cause) {
           return AloneGradeOf(camera, cause) == Grade::kBad;
         });
}

bool MoreViewsHelp(const CameraReport& camera) {
  switch (camera.calibration.status) {
    case SolveStatus::kNotSolved:
      return !IsGivenWrong(camera);
    case SolveStatus::kUndetermined:
    case SolveStatus::kDegenerate:
      return !ManyAreRejected(camera);
    default:
      return Judge(camera).grade != Grade::kBad;
  }
}

void JudgeCauses(const CameraReport& camera, Judgement* judgement) {
  if (!camera.contradiction.empty()) return;
  // A cause that is an alarm by itself has the next likeliest named, too.
  Grade alarm = judgement->grade();
  for (const Cause& cause : camera.causes) alarm = std::max(alarm, AloneGradeOf(camera, cause));
  const char* prefix = "Likeliest cause: ";
  Grade first = Grade::kGood;
  for (const Cause* cause : CausesToName(camera, alarm)) {
    std::string sentence = prefix + cause->words + "." + Moves(*cause);
    prefix = "Second likeliest: ";
    const Grade grade = AloneGradeOf(camera, *cause);
    first = std::max(first, grade);
    if (IsFeared(*cause)) {
      sentence += " It may be chance (" + Number(cause->Sigmas(), 1) + " sigma): measure it.";
    }
    if (first == Grade::kGood) {
      judgement->AddReason(sentence);
    } else {  // the second stands beside the first
      judgement->Cause(grade == Grade::kGood ? first : grade, sentence);
    }
  }
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
  const std::string away = "up to " + Number(worst.rotation_deg, 2) + "° and " +
                           Number(worst.translation_mm, 0) + " mm away";
  if (rivals > 0) {
    judgement->Usable(std::to_string(rivals) + of + " ended elsewhere, " + away +
                      ", and fits about as well: the result depends on the start.");
  } else if (stuck > 0) {
    judgement->AddReason(std::to_string(stuck) + of + " ended elsewhere, " + away +
                         ", and fits worse: the first guess has to be nearer than that.");
  } else {
    judgement->AddReason("From " + Count(camera.other_starts.size(), "other start") +
                         " it comes to the same result.");
  }
}

void JudgeStatus(const CameraReport& camera, const std::optional<NextView>& next_view,
                 Judgement* judgement) {
  const CameraCalibration& calibration = camera.calibration;
  const std::string& detail = calibration.detail;
  switch (calibration.status) {
    case SolveStatus::kUndetermined:
    case SolveStatus::kDegenerate:
      judgement->Headline("Do not use it: these views do not determine the pose.");
      // Views that were rejected may have.
      if (ManyAreRejected(camera)) JudgeRejections(camera, judgement);
      judgement->Bad("Status of the solve: " + calibration.StatusText());
      if (next_view && !ManyAreRejected(camera)) judgement->Bad("Next: " + next_view->words);
      break;
    case SolveStatus::kNotSolved:
      // Where no view is left, why they were rejected says more.
      if (camera.used.empty()) JudgeRejections(camera, judgement);
      judgement->Bad("There was no solve" + (detail.empty() ? "." : ": " + detail));
      if (!camera.used.empty()) JudgeRejections(camera, judgement);
      break;
    case SolveStatus::kContradicted:
      break;  // at the end: what contradicts it may be said by then
    case SolveStatus::kNotConverged:
      judgement->Bad("The solve did not converge" + (detail.empty() ? "." : ": " + detail));
      break;
    case SolveStatus::kFirstGuessKept:
      judgement->AddReason("Status of the solve: " + calibration.StatusText());
      break;
    case SolveStatus::kConverged:
      break;
  }
}

// Of a calibration that was judged before, whose verdict's first reason is the detail.
void JudgeContradicted(const CameraCalibration& calibration, Judgement* judgement) {
  if (calibration.status != SolveStatus::kContradicted) return;
  if (!calibration.detail.empty() && judgement->SaysBad(calibration.detail)) return;
  judgement->Bad("Status of the solve: " + calibration.StatusText());
}

void JudgeColouring(const ColouringSigma& at, Judgement* judgement) {
  const std::string uncertain = "The projection uncertainty of a point " + Number(kJudgedAtM, 0) +
                                " m away is " + Number(at.worst_px, 2) +
                                " px (1 sigma) where it is worst in the image";
  if (at.worst_px > kMostUncertainPx) {
    judgement->Doubtful(uncertain + ", more than " + Number(kMostUncertainPx, 0) +
                        " px: too uncertain. Check the lens (rgbdt intrinsics)" +
                        (judgement->more_views() ? ", and take more views in all parts of the "
                                                   "image."
                                                 : "."));
  } else if (at.worst_px > kUncertainPx) {
    judgement->Usable(
        uncertain + ", more than " + Number(kUncertainPx, 0) + " px" +
        (judgement->more_views() ? ": take more views in that part of the image." : "."));
  } else {
    judgement->AddReason(uncertain + ".");
  }
}

}  // namespace

const ColouringSigma* JudgedColouring(const CameraReport& camera) {
  if (!camera.sigma) return nullptr;
  for (const ColouringSigma& at : camera.sigma->colouring) {
    if (std::abs(at.distance_m - kJudgedAtM) < 1e-6 && std::isfinite(at.worst_px)) return &at;
  }
  return nullptr;
}

Verdict Judge(const CameraReport& camera, const std::optional<NextView>& next_view) {
  Judgement judgement;
  if (IsGivenWrong(camera)) judgement.NoMoreViews();
  JudgeStatus(camera, next_view, &judgement);
  JudgeAgreement(camera, &judgement);
  JudgeResiduals(camera, &judgement);
  if (!camera.cannot_tell.empty()) judgement.Usable(camera.cannot_tell);
  if (const auto* at = JudgedColouring(camera)) JudgeColouring(*at, &judgement);
  JudgeStarts(camera, &judgement);
  if (camera.used.size() < kFewViews) {
    judgement.Usable("Views used: only " + std::to_string(camera.used.size()) + "; take " +
                     std::to_string(kFewViews) + " or more.");
  }
  if (camera.calibration.converged() && !camera.calibration.covariance) {
    judgement.Usable(
        "How exact the result is cannot be told by this method; --method auto tells "
        "it.");
  }
  JudgeCauses(camera, &judgement);
  JudgeContradicted(camera.calibration, &judgement);
  if (camera.truth_error) {
    judgement.AddReason("The truth is known here: the result is " +
                        Number(camera.truth_error->rotation_deg, 3) + "° and " +
                        Number(camera.truth_error->translation_mm, 1) + " mm away from it.");
  }
  return judgement.Finish();
}

const NextView* NextViewOf(const Report& report) {
  const auto& cameras = report.cameras;
  const bool help = std::all_of(cameras.begin(), cameras.end(), MoreViewsHelp);
  return report.next_view && help ? &*report.next_view : nullptr;
}

Grade GradeOf(const Report& report) {
  if (report.cameras.empty()) return Grade::kNone;
  Grade worst = Grade::kGood;
  for (const CameraReport& camera : report.cameras) {
    worst = std::max(worst, Judge(camera, report.next_view).grade);
  }
  return worst;
}

Report WithVerdicts(Report report) {
  for (CameraReport& camera : report.cameras) camera.verdict = Judge(camera, report.next_view);
  return report;
}

Calibration JudgedCalibration(const Report& report, const Rig& rig) {
  Calibration calibration = report.ToCalibration();
  calibration.sensors = SensorsOf(rig);
  for (CameraCalibration& camera : calibration.cameras) {
    if (!camera.converged()) continue;
    for (const CameraReport& judged : report.cameras) {
      if (judged.calibration.camera != camera.camera) continue;
      const Verdict verdict = Judge(judged);
      if (verdict.grade == Grade::kDoubtful) {
        camera.detail = kDoubtfulDetail + verdict.reasons.front() +
                        (camera.detail.empty() ? "" : "; " + camera.detail);
      }
      if (verdict.grade != Grade::kBad) continue;
      camera.status = SolveStatus::kContradicted;
      camera.detail = verdict.reasons.front();
    }
  }
  // Solved together: what contradicts the cameras' views has the LIDARs' poses bent, too.
  const auto contradicted =
      std::find_if(calibration.cameras.begin(), calibration.cameras.end(),
                   [](const auto& camera) { return camera.status == SolveStatus::kContradicted; });
  if (contradicted == calibration.cameras.end()) return calibration;
  for (LidarCalibration& lidar : calibration.lidars) {
    if (!lidar.converged()) continue;
    lidar.status = SolveStatus::kContradicted;
    lidar.detail = "it was solved together with camera " + contradicted->camera +
                   ", which is not to be used: " + contradicted->detail;
  }
  return calibration;
}

}  // namespace rgbdt
