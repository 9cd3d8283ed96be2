#include "calib/present/report/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/model/statistics.h"
#include "calib/present/report/said_once.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr std::size_t kFewViews = 5;
// Held-out views always fit a little worse; beyond this the solve is overfitted.
constexpr double kWorse = 1.5, kWorsePx = 0.5;
constexpr double kElsewhereDeg = 0.5, kElsewhereMm = 50;
// Of what edges alone and planes alone say: so far apart nobody knows which of them is right.
constexpr double kFarApartDeg = 1, kFarApartMm = 100;
constexpr double kClearlyWorse = 1.2;
constexpr double kUncertainPx = 1;
// Of the views' scatter over what is stated (variance): above the first it is said, and the
// enlarged sigma makes good for it; above the second nobody knows what the views have wrong.
constexpr double kMuchScatter = 2.5, kMostScatter = 6;
constexpr double kUnlikely = 1e-3;
// Of held-out views' RMS [sigma]: beyond it most views contradict the pose, whatever noise does.
constexpr double kWrongWhitened = 5;
// Of views left out, over what is expected: by chance the mean over eight views stays below this.
constexpr double kMostMisfit = 2;
// Of what was given wrong, in sigmas of the pose that it moves.
constexpr double kMovesLittle = 1, kMovesMuch = 4;
// What is less likely than this is not named as a cause.
constexpr double kLeastNamedSigmas = 1;
constexpr std::size_t kMostNamed = 2;
constexpr std::size_t kManyRejected = 3;
constexpr char kWhyViewsDisagree[] =
    "Check the lens (rgbdt intrinsics), the board's size in the rig file, and that board and rig "
    "stood still.";

// What speaks against the result comes first, in the order in which it was said.
class Judgement {
 public:
  void AddReason(const std::string& sentence) { others_.push_back(sentence); }
  void Usable(const std::string& sentence) { Say(Grade::kUsable, sentence); }
  void Doubtful(const std::string& sentence) { Say(Grade::kDoubtful, sentence); }
  void Bad(const std::string& sentence) { Say(Grade::kBad, sentence); }
  Grade grade() const { return grade_; }
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
  std::string headline_;
  std::vector<std::pair<Grade, std::string>> causes_, against_;
  std::vector<std::string> others_;  // reasons that are no alarm
};

std::string Moves(const Cause& cause) {
  if (!cause.moves_sigma) return "";
  return " Put right, it moves the result by " + Number(*cause.moves_sigma, 1) + " sigma.";
}

// What was given wrong, by how much the result moves where it is put right.
Grade GradeOf(const Cause& cause) {
  if (!cause.moves_sigma) return Grade::kDoubtful;
  return *cause.moves_sigma > kMovesMuch     ? Grade::kBad
         : *cause.moves_sigma > kMovesLittle ? Grade::kDoubtful
                                             : Grade::kUsable;
}

// Those to be named, what counts most first. Where something else says that all is not well
// (`alarm`), also what may be behind it.
std::vector<const Cause*> CausesToName(const CameraReport& camera, bool alarm) {
  std::vector<const Cause*> named;
  const auto wrong = [](const Cause& cause) { return cause.Sigmas() >= kGivenWrongSigmas; };
  for (const Cause& cause : camera.causes) {
    if (wrong(cause) || (alarm && cause.Sigmas() >= kLeastNamedSigmas)) named.push_back(&cause);
  }
  std::stable_sort(named.begin(), named.end(), [&](const Cause* a, const Cause* b) {
    if (wrong(*a) != wrong(*b)) return wrong(*a);
    return wrong(*a) && GradeOf(*a) > GradeOf(*b);
  });
  if (named.size() > kMostNamed) named.resize(kMostNamed);
  return named;
}

void JudgeCauses(const CameraReport& camera, Judgement* judgement) {
  if (!camera.contradiction.empty()) return;
  // Where it left no pose, nothing tells how far that would move.
  const bool solved = camera.calibration.status != SolveStatus::kNotSolved;
  const char* prefix = "Likeliest cause: ";
  for (const Cause* cause : CausesToName(camera, judgement->grade() >= Grade::kDoubtful)) {
    const std::string sentence = prefix + cause->words + "." + Moves(*cause);
    prefix = "Second likeliest: ";
    if (cause->Sigmas() >= kGivenWrongSigmas) {
      judgement->Cause(solved ? GradeOf(*cause) : Grade::kBad, sentence);
    } else {
      judgement->AddReason(sentence);
    }
  }
}

// Whether the views fit together at all: before any figure that takes them to.
void JudgeAgreement(const CameraReport& camera, Judgement* judgement) {
  if (!camera.contradiction.empty()) judgement->Cause(Grade::kBad, camera.contradiction);
  const std::size_t views = camera.used.size() + camera.heldout.size() + camera.rejected.size();
  if (camera.rejected.size() >= kManyRejected && 4 * camera.rejected.size() > views) {
    judgement->Doubtful("Rejected: " + std::to_string(camera.rejected.size()) + " of " +
                        Count(views, "view") + "; why stands in the table of views.");
  }
  double misfit = 0;
  double expected = 0;
  for (const Fold& fold : camera.folds) {
    misfit += fold.misfit / static_cast<double>(camera.folds.size());
    expected += fold.expected_misfit / static_cast<double>(camera.folds.size());
  }
  if (misfit > kMostMisfit * expected) {
    judgement->Usable(
        "The views contradict each other: what the others say misses a view by a "
        "chi-square of " +
        Number(misfit, 0) + " where " + Number(expected, 0) +
        " is expected (50 is the most that is counted). " + kWhyViewsDisagree);
  }
  const auto& scatter = camera.view_scatter;
  if (!scatter || !(scatter->factor > kMuchScatter) || !(scatter->Chance() < kUnlikely)) return;
  const std::string scatters =
      "The views scatter " + Number(std::sqrt(scatter->factor), 1) +
      " times as much as their own sigmas say; the stated sigma was enlarged for it, but what "
      "moves all of them alike is not in it. " +
      kWhyViewsDisagree;
  if (scatter->factor > kMostScatter) {
    judgement->Doubtful(scatters);
  } else {
    judgement->Usable(scatters);
  }
}

void JudgeScene(const SceneCheck& scene, Judgement* judgement) {
  judgement->AddReason("Images show " + Number(100 * scene.shown, 0) + "% of the " +
                       Number(scene.edges, 0) + " depth edges of the clouds.");
  if (!scene.heldout_start || !scene.heldout_result) {
    judgement->Usable(
        "It was not checked: no sweep was left out, or none of those shows depth edges.");
    return;
  }
  if (*scene.heldout_result < *scene.heldout_start) return;  // the status says it
  judgement->AddReason(
      "On sweeps that the solver never saw, edges are met at least as well as by the start "
      "(log-likelihood of an edge " +
      Number(*scene.heldout_result, 3) + ", by the start " + Number(*scene.heldout_start, 3) +
      ").");
}

void JudgeFit(const CameraReport& camera, Judgement* judgement) {
  if (camera.scene) return JudgeScene(*camera.scene, judgement);
  const TrainHeldout& rms = camera.edge_rms_px;
  if (!rms.heldout) {
    judgement->Usable("It was not checked: no view that was kept from the solver could be used.");
    return;
  }
  const std::string held =
      "On views that the solver never saw, the board's outline is met within " +
      Number(*rms.heldout, 2) + " px RMS";
  if (!rms.train) {
    judgement->AddReason(held + ".");
  } else if (*rms.heldout > kWorse * *rms.train + kWorsePx) {
    judgement->Usable(held + ", clearly worse than the " + Number(*rms.train, 2) +
                      " px on the views used: take more views, at other distances and tilts.");
  } else {
    judgement->AddReason(held + ", as well as on the views used (" + Number(*rms.train, 2) +
                         " px).");
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

// Without a pose: why views could not be used; what is alike is said once.
void JudgeRejections(const CameraReport& camera, Judgement* judgement) {
  std::vector<Said> rejected;
  for (const RejectedView& view : camera.rejected) rejected.push_back({"", view.view, view.why});
  for (const std::string& line : SaidOnce(rejected, "rejected")) judgement->Bad(line + ".");
}

void JudgeStatus(const CameraReport& camera, const std::optional<NextView>& next_view,
                 Judgement* judgement) {
  const CameraCalibration& calibration = camera.calibration;
  const std::string& detail = calibration.detail;
  switch (calibration.status) {
    case SolveStatus::kUndetermined:
    case SolveStatus::kDegenerate:
      judgement->Headline("Do not use it: these views do not determine the pose.");
      judgement->Bad("Status of the solve: " + calibration.StatusText());
      if (next_view) judgement->Bad("Next: " + next_view->words);
      break;
    case SolveStatus::kNotSolved:
      // Where no view is left, why they were rejected says more.
      if (camera.used.empty()) JudgeRejections(camera, judgement);
      judgement->Bad("There was no solve" + (detail.empty() ? "." : ": " + detail));
      if (!camera.used.empty()) JudgeRejections(camera, judgement);
      break;
    case SolveStatus::kContradicted:
      judgement->Bad("Status of the solve: " + calibration.StatusText());
      break;
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

void JudgeColouring(const ColouringSigma& at, Judgement* judgement) {
  const std::string uncertain = "The projection uncertainty of a point " + Number(kJudgedAtM, 0) +
                                " m away is " + Number(at.worst_px, 2) +
                                " px (1 sigma) where it is worst in the image";
  if (at.worst_px > kUncertainPx) {
    judgement->Usable(uncertain + ", more than " + Number(kUncertainPx, 0) +
                      " px: take more views in that part of the image.");
  } else {
    judgement->AddReason(uncertain + ".");
  }
}

void JudgeHalves(const Halves& halves, Judgement* judgement) {
  const std::string differ = "Two halves of the views, each solved separately, differ by " +
                             PoseErrorText(halves.difference);
  if (halves.chi2 > kUnlikelyChi2) {
    judgement->Doubtful(differ + ", more than their sigmas allow (chi-square " +
                        Number(halves.chi2, 1) + ", by chance above " + Number(kUnlikelyChi2, 1) +
                        " once in a thousand times): the stated uncertainty cannot be trusted.");
  } else {
    judgement->AddReason(differ +
                         (std::isnan(halves.chi2) ? "." : ", no more than their sigmas allow."));
  }
}

// Where the solver found that their own sigmas do not allow it, it enlarged the stated one.
void JudgeEdgesAndPlanes(const Halves& apart, Judgement* judgement) {
  const bool far =
      apart.difference.rotation_deg > kFarApartDeg || apart.difference.translation_mm > kFarApartMm;
  const bool agree = !(apart.chi2 > kUnlikelyChi2);
  const bool allowed = agree || apart.sigma_enlarged.has_value();
  if (agree && !far) return;
  const std::string put = "The boards' edges alone and their planes alone put the camera " +
                          PoseErrorText(apart.difference) + " apart, ";
  const std::string off =
      "the LIDAR's beams or ranges, the lens or the board's size are off in a way that is not "
      "known";
  if (allowed) {
    judgement->Usable(put + "and the stated sigma is large enough to allow it: " + off + ".");
    return;
  }
  const std::string why = put + "more than their sigmas allow (chi-square " +
                          Number(apart.chi2, 1) + "): " + off +
                          ", and the result may be off by more than stated.";
  if (far) {
    judgement->Doubtful(why);
  } else {
    judgement->Usable(why);
  }
}

// Of the held-out views' own RMS [sigma]: a single one that is wrong does not count.
std::optional<double> MedianWhitened(const CameraReport& camera) {
  std::vector<double> rms;
  for (const ViewQuality& view : camera.views) {
    if (view.heldout && view.edge_rms_whitened) rms.push_back(*view.edge_rms_whitened);
  }
  return rms.empty() ? camera.edge_rms_whitened.heldout : std::optional(Median(std::move(rms)));
}

// Sigmas that are enlarged because views scatter already say what crossings do.
void JudgeWhitened(const CameraReport& camera, Judgement* judgement) {
  const std::optional<double>& rms = camera.edge_rms_whitened.heldout;
  if (!rms) return;
  const double most = kMostWhitened * std::sqrt(camera.variance_factor);
  const std::string miss = "On the held-out views the beams miss the board's edge by " +
                           Number(*rms, 2) + " sigmas (RMS; expected: 1): they are ";
  if (*MedianWhitened(camera) > kWrongWhitened * std::sqrt(camera.variance_factor)) {
    judgement->Bad(miss + "not where this pose puts them.");
  } else if (*rms > most && *MedianWhitened(camera) > most) {
    judgement->Doubtful(miss +
                        "less exact than stated, and the stated uncertainty cannot be trusted.");
  } else if (*rms > most) {
    judgement->Usable(miss + "less exact than stated in some views, not in most.");
  } else if (*rms < kLeastWhitened) {
    judgement->AddReason(miss + "more exact than stated.");
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
  JudgeStatus(camera, next_view, &judgement);
  JudgeAgreement(camera, &judgement);
  JudgeFit(camera, &judgement);
  JudgeWhitened(camera, &judgement);
  if (camera.halves) JudgeHalves(*camera.halves, &judgement);
  if (camera.edges_planes) JudgeEdgesAndPlanes(*camera.edges_planes, &judgement);
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
  if (camera.truth_error) {
    judgement.AddReason("The truth is known here: the result is " +
                        Number(camera.truth_error->rotation_deg, 3) + "° and " +
                        Number(camera.truth_error->translation_mm, 1) + " mm away from it.");
  }
  return judgement.Finish();
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
