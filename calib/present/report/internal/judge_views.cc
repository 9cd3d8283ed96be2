#include "calib/present/report/internal/judge_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/statistics.h"
#include "calib/present/report/said_once.h"
#include "calib/present/report/verdict.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

// Held-out views always fit a little worse; beyond this the solve is overfitted.
constexpr double kWorse = 1.5, kWorsePx = 0.5;
// Of what edges alone and planes alone say: so far apart nobody knows which of them is right.
constexpr double kFarApartDeg = 1, kFarApartMm = 100;
// Of the views' scatter over what is stated (variance): above the first it is said, and the
// enlarged sigma makes good for it; above the second nobody knows what the views have wrong; above
// the third the pose is none.
constexpr double kMuchScatter = 2.5, kMostScatter = 6, kNoPoseScatter = 100;
constexpr double kUnlikely = 1e-3;
// Of held-out views' RMS [sigma]: beyond it most views contradict the pose, whatever noise does.
constexpr double kWrongWhitened = 5;
// On the board, whatever sigma is stated: ranges scatter by 5 to 30 mm, and a beam's width at 10 m
// is some 30 mm, a third of which an edge is uncertain by.
constexpr double kMostOnBoardMm = 60;
// Of views left out, over what is expected: by chance the mean over eight views stays below this.
constexpr double kMostMisfit = 2;
constexpr std::size_t kManyRejected = 3;
constexpr char kWhyViewsDisagree[] =
    "Check the lens (rgbdt intrinsics), the board's size in the rig file, and that board and rig "
    "stood still.";

// A copy speaks against nothing.
std::vector<Said> RejectedOf(const CameraReport& camera) {
  std::vector<Said> rejected;
  for (const RejectedView& view : camera.rejected) {
    if (!view.copy) rejected.push_back({"", view.view, view.why});
  }
  return rejected;
}

std::size_t ViewsOf(const CameraReport& camera) {
  return camera.used.size() + camera.heldout.size() + RejectedOf(camera).size();
}

// Where the status tells why each view was rejected.
bool RejectionsAreSaid(SolveStatus status) {
  return status == SolveStatus::kNotSolved || status == SolveStatus::kUndetermined ||
         status == SolveStatus::kDegenerate;
}

// How many views were rejected, and why most of them were, where that is one reason.
std::string ManyRejected(const CameraReport& camera, std::size_t views) {
  const std::vector<Said> rejected = RejectedOf(camera);
  const SaidAlike most = MostSaid(rejected);
  const std::string many =
      "Rejected: " + std::to_string(rejected.size()) + " of " + Count(views, "view") + "; ";
  if (2 * most.count <= rejected.size()) return many + "why stands in the table of views.";
  return many + std::to_string(most.count) + " of them alike, as " + most.first.view + ": " +
         most.first.text + ".";
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
  if (!scene.joined) {  // no sweep of the same place would show it
    judgement->Usable(
        "Nothing but this place tells it: what moves its edges all alike is not in the stated "
        "sigma. Refine in another place, too, and compare the two (rgbdt compare).");
  }
  judgement->AddReason(
      "On sweeps that the solver never saw, edges are met at least as well as by the start "
      "(log-likelihood of an edge " +
      Number(*scene.heldout_result, 3) + ", by the start " + Number(*scene.heldout_start, 3) +
      ").");
}

void JudgeFit(const CameraReport& camera, Judgement* judgement) {
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
    judgement->Usable(
        held + ", clearly worse than the " + Number(*rms.train, 2) + " px on the views used" +
        (camera.variance_factor > kMuchScatter ? ". " + std::string(kWhyViewsDisagree)
         : judgement->more_views()             ? ": take more views, at other distances and tilts."
                                               : "."));
  } else {
    judgement->AddReason(held + ", as well as on the views used (" + Number(*rms.train, 2) +
                         " px).");
  }
}

// A sigma that is stated large enough allows any residual; sensors do not.
void JudgeOnBoard(const CameraReport& camera, Judgement* judgement) {
  const auto judge = [&](const TrainHeldout& rms, const std::string& what) {
    const double most = std::max(rms.train.value_or(0), rms.heldout.value_or(0));
    if (!(most > kMostOnBoardMm)) return;
    judgement->Doubtful(what + " by up to " + Number(most, 0) + " mm RMS, more than the " +
                        Number(kMostOnBoardMm, 0) + " mm that LIDARs leave. " + kWhyViewsDisagree);
  };
  judge(camera.edge_rms_mm, "On the board, the beams miss its edges");
  judge(camera.plane_rms_mm, "The cloud's points miss the board's plane");
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

void JudgeAgreement(const CameraReport& camera, Judgement* judgement) {
  if (!camera.contradiction.empty()) judgement->Cause(Grade::kBad, camera.contradiction);
  if (ManyAreRejected(camera) && !RejectionsAreSaid(camera.calibration.status)) {
    judgement->Doubtful(ManyRejected(camera, ViewsOf(camera)));
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
  if (!scatter || !(scatter->factor > kMuchScatter) || !(scatter->Chance() < kUnlikely)) {
    if (scatter && camera.variance_factor > kMuchScatter) {
      judgement->Usable(
          "The stated sigma was enlarged " + Number(std::sqrt(camera.variance_factor), 1) +
          " times: the views seem to scatter more than they state, which may be chance. " +
          kWhyViewsDisagree);
    }
    return;
  }
  const std::string scatters =
      "The views scatter " + Number(std::sqrt(scatter->factor), 1) +
      " times as much as their own sigmas say; the stated sigma was enlarged for it, but what "
      "moves all of them alike is not in it. " +
      kWhyViewsDisagree;
  if (scatter->factor > kNoPoseScatter) {
    judgement->Bad(scatters);
  } else if (scatter->factor > kMostScatter) {
    judgement->Doubtful(scatters);
  } else {
    judgement->Usable(scatters);
  }
}

bool ManyAreRejected(const CameraReport& camera) {
  const std::size_t rejected = RejectedOf(camera).size();
  return rejected >= kManyRejected && 4 * rejected > ViewsOf(camera);
}

bool ViewsDisagree(const CameraReport& camera) {
  return camera.variance_factor > kMuchScatter ||
         (camera.edges_planes && camera.edges_planes->chi2 > kUnlikelyChi2);
}

void JudgeResiduals(const CameraReport& camera, Judgement* judgement) {
  if (camera.scene) {
    JudgeScene(*camera.scene, judgement);
  } else {
    JudgeFit(camera, judgement);
  }
  JudgeWhitened(camera, judgement);
  JudgeOnBoard(camera, judgement);
  if (camera.halves) JudgeHalves(*camera.halves, judgement);
  if (camera.edges_planes) JudgeEdgesAndPlanes(*camera.edges_planes, judgement);
}

void JudgeRejections(const CameraReport& camera, Judgement* judgement) {
  for (const std::string& line : SaidOnce(RejectedOf(camera), "rejected"))
    judgement->Bad(line + ".");
}

}  // namespace rgbdt
