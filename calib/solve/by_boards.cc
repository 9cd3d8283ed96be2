#include "calib/solve/by_boards.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/model/stopwatch.h"
#include "calib/model/text.h"
#include "calib/solve/closure.h"
#include "calib/solve/colouring.h"
#include "calib/solve/compare.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/internal/cross_check.h"
#include "calib/solve/internal/disagreement.h"
#include "calib/solve/internal/edges_planes.h"
#include "calib/solve/internal/encoder_delay.h"
#include "calib/solve/internal/further_lidars.h"
#include "calib/solve/internal/given_wrong.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/lidar_reports.h"
#include "calib/solve/internal/mount_moved.h"
#include "calib/solve/internal/next_view.h"
#include "calib/solve/internal/nuisances.h"
#include "calib/solve/internal/scatter_sigmas.h"

namespace rgbdt {
namespace {

CameraCalibration CalibrationOf(const JointResult& result, std::size_t camera) {
  const bool converged = result.solution.converged;
  const PoseAndLensCovariance covariance = CovarianceOf(result, camera);
  CameraCalibration calibration{result.joint.cameras[camera].views.spec->name,
                                result.solution.state.camera_from_lidar[camera],
                                Matrix6d(covariance.topLeftCorner<6, 6>()),
                                converged ? SolveStatus::kConverged : SolveStatus::kNotConverged,
                                converged ? "" : "the joint solve did not settle"};
  if (!result.joint.problem.lens_priors[camera].isZero(0)) {
    calibration.lens =
        SolvedLens{result.solution.state.lenses[camera], covariance.bottomRows<kLensNumbers>()};
  }
  calibration.range_errors = RangeErrorsOf(result);
  return calibration;
}

// A camera's report with what the joint solve found, which took `seconds`.
CameraReport WithSolution(const JointResult& result, std::size_t camera, double seconds) {
  CameraReport report = result.joint.cameras[camera].views.report;
  report.calibration = CalibrationOf(result, camera);
  report.nuisance = NuisancesOf(result, camera);
  report.view_scatter = result.view_scatter;
  report.variance_factor = result.variance_factor;
  const auto views = result.joint.problem.views.size();
  constexpr double kSayEnlarged = 1.2;  // of variance
  if (result.placements.factor > kSayEnlarged) {
    report.warnings.push_back(Format(
        "%zu views show the board in %d places: more views of one place tell little more, so "
        "the stated sigma was enlarged %.1f times; carry the board elsewhere between views",
        views, result.placements.places, std::sqrt(result.placements.factor)));
  }
  for (const RefutedOffset& refuted : result.refuted_offsets) {
    if (refuted.lidar) continue;
    report.warnings.push_back(
        RangesAreOff(report.calibration.range_errors->offset_m, refuted.known_m));
  }
  report.solve_s += seconds / static_cast<double>(result.joint.cameras.size());
  return report;
}

EdgeModel EdgesOf(const JointResult& result) {
  const BoardProblem& problem = result.joint.problem;
  const BoardState& state = result.solution.state;
  return {problem.target, state.shared, problem.priors, problem.ranges, state.range_terms};
}

// Metres more along each boundary point's beam, where the ranges were found to be off.
CameraViews WithRangeOffset(CameraViews camera) {
  if (!camera.report.calibration.range_errors) return camera;
  const double offset_m = camera.report.calibration.range_errors->offset_m.value;
  for (CameraView& view : camera.all) {
    if (!view.cloud) continue;
    for (Eigen::Vector3d& p : view.cloud->boundary) p += offset_m * p.normalized();
  }
  return camera;
}

CameraViews Judged(const EdgeModel& edges, CameraViews camera) {
  camera.report.calibration = WithDegeneracy(camera);
  camera.report = EnlargedWhereTheyDiffer(std::move(camera.report));
  camera = WithRangeOffset(std::move(camera));
  camera.report = JudgeViews(edges, camera);
  return camera;
}

// How far cameras moved between sessions, by this solve.
std::vector<MountChange> ChangesOf(const JointResult& result) {
  std::vector<MountChange> changes;
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    const std::size_t first = result.joint.problem.LensOf(c);
    if (first == c) continue;
    const CameraViews& from = result.joint.cameras[first].views;
    const CameraViews& to = result.joint.cameras[c].views;
    const auto at = SharedPlaces::Pose(c), at_first = SharedPlaces::Pose(first);
    Matrix6d together = result.PoseFactor() * result.solution.covariance.block<6, 6>(at, at_first);
    if (result.encoder_delay) {
      const Eigen::VectorXd& move = result.encoder_delay->unknown_move;
      together += move.segment<6>(at) * move.segment<6>(at_first).transpose();
    }
    changes.push_back(
        {first, c, Compare(from.report.calibration, to.report.calibration, to.spec, together)});
  }
  return changes;
}

// As the camera's stated sigma was, where its edges and planes contradict each other.
NextView Enlarged(NextView next, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    const auto& apart = camera.views.report.edges_planes;
    if (camera.views.spec->name != next.camera || !apart || !apart->sigma_enlarged) continue;
    next.sigma_before_px *= *apart->sigma_enlarged;
    next.sigma_after_px *= *apart->sigma_enlarged;
  }
  return next;
}

// Cameras that were solved together, and where to hold the board next.
struct SolvedGroup {
  std::vector<GuessedCamera> cameras;
  std::vector<MountChange> changes;  // indices into `cameras`
  std::optional<NextView> next_view;
  std::vector<LidarReport> lidars;
  std::optional<EncoderDelay> encoder_delay;
};

// Whether something is surely given wrong: that bends all else, too.
bool IsExplained(const std::vector<Cause>& causes) {
  return std::any_of(causes.begin(), causes.end(),
                     [](const Cause& cause) { return cause.Sigmas() >= kGivenWrongSigmas; });
}

std::size_t ImagesUsed(const JointResult& result) {
  std::size_t images = 0;
  for (const BoardView& view : result.joint.problem.views) images += view.images.size();
  return images;
}

// Where a lens was refuted, boards are posed anew by the one that was found, so that those that the
// given one bent out of shape have their say, and all is solved again. `detected`: the cameras'
// views before any guess.
JointResult SolveWithLensFound(const Target& target, const CalibrateOptions& options,
                               std::vector<GuessedCamera> cameras,
                               const std::vector<CameraViews>& detected,
                               const std::vector<LidarViews>& lidars) {
  const auto solve = [&](std::vector<GuessedCamera> guessed) {
    const double offset_sigma_m = options.first_guess.range_offset_sigma_m;
    JointProblem joint = MakeJointProblem(target, std::move(guessed), offset_sigma_m);
    AddLidars(lidars, options.min_views, offset_sigma_m, &joint);
    return SolveJointly(std::move(joint));
  };
  JointResult result = solve(std::move(cameras));
  std::vector<CameraViews> posed;
  bool refuted = false;
  for (std::size_t c = 0; c < detected.size(); ++c) {
    const bool off = result.lenses_off[c].contradicts();
    posed.push_back(off ? PosedAgain(detected[c], result.solution.state.lenses[c], target)
                        : detected[c]);
    refuted = refuted || off;
  }
  if (!refuted) return result;
  std::vector<GuessedCamera> guessed = GuessCameras(options, std::move(posed));
  for (const GuessedCamera& camera : guessed) {
    if (!camera.guess.camera_from_lidar) return result;
  }
  JointResult again = solve(std::move(guessed));
  return ImagesUsed(again) < ImagesUsed(result) ? std::move(result) : std::move(again);
}

// With the further LIDARs where these fit the cameras; where not, they are left, with the reason.
JointResult SolveWithLidars(const Target& target, const CalibrateOptions& options,
                            std::vector<GuessedCamera> cameras,
                            const std::vector<CameraViews>& detected,
                            const std::vector<LidarViews>& lidars) {
  if (lidars.empty()) return SolveWithLensFound(target, options, std::move(cameras), detected, {});
  JointResult with = SolveWithLensFound(target, options, cameras, detected, lidars);
  const std::string why = WhyLidarsDoNotFit(with);
  if (why.empty()) return with;
  JointResult alone = SolveWithLensFound(target, options, std::move(cameras), detected, {});
  alone.joint.lidars_left = LeftOut(lidars, why);
  return alone;
}

SolvedGroup SolveGroup(const Target& target, const CalibrateOptions& options,
                       std::vector<GuessedCamera> cameras, const std::vector<CameraViews>& detected,
                       const std::vector<LidarViews>& lidars) {
  const Stopwatch watch;
  JointResult result = SolveWithLidars(target, options, std::move(cameras), detected, lidars);
  const double seconds = watch.Seconds();
  std::vector<std::vector<Cause>> causes = GivenWrong(result);
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    CameraReport& report = result.joint.cameras[c].views.report;
    report = WithSolution(result, c, seconds);
    report.causes = std::move(causes[c]);
    // Where nothing that was given explains it.
    if (IsExplained(report.causes)) continue;
    for (Cause& cause : BeyondPriors(result, c)) report.causes.push_back(std::move(cause));
  }
  result = HoldEdgesAgainstPlanes(std::move(result));
  SolvedGroup solved;
  solved.encoder_delay = result.encoder_delay;
  solved.lidars = ReportsOfLidars(result, options.min_views);
  solved.changes = ChangesOf(result);
  const EdgeModel edges = EdgesOf(result);
  if (options.diagnostics) {
    // Parts of the views may not tell where a further LIDAR is; the cameras they do.
    result = CrossValidate(WithoutLidars(std::move(result)), options.folds);
    // Of a session that is over there is no next view.
    if (solved.changes.empty()) solved.next_view = FindNextView(result);
  }
  solved.cameras = std::move(result.joint.cameras);
  for (GuessedCamera& camera : solved.cameras) {
    camera.views = Judged(edges, std::move(camera.views));
  }
  if (solved.next_view) solved.next_view = Enlarged(std::move(*solved.next_view), solved.cameras);
  return solved;
}

// Which of the cameras, those with a guess, are solved together: all, or those of one name.
std::vector<std::vector<std::size_t>> GroupsOf(const std::vector<GuessedCamera>& cameras,
                                               bool joint) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (!cameras[c].guess.camera_from_lidar) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& others) {
      return joint || cameras[others.front()].views.spec->name == cameras[c].views.spec->name;
    });
    if (group == groups.end()) group = groups.emplace(group);
    group->push_back(c);
  }
  return groups;
}

// Where no camera has a first guess: it is the cameras that tell which boards are the target.
LidarReport WithoutCamera(LidarReport report) {
  report.calibration.detail = "no camera was calibrated, and cameras tell which board it is";
  return report;
}

// Of cameras that are solved apart, the worst one's.
std::optional<NextView> Worse(std::optional<NextView> a, std::optional<NextView> b) {
  return b && (!a || b->sigma_before_px > a->sigma_before_px) ? std::move(b) : std::move(a);
}

// By which of the groups that are solved apart it is better known.
std::optional<EncoderDelay> SurerOf(std::optional<EncoderDelay> a, std::optional<EncoderDelay> b) {
  return b && (!a || b->seconds.sigma < a->seconds.sigma) ? std::move(b) : std::move(a);
}

// The first guesses; where views do not agree on one, what makes them.
std::vector<GuessedCamera> GuessOrSayWhyNot(const Target& target, const CalibrateOptions& options,
                                            std::vector<CameraViews>* cameras) {
  std::vector<GuessedCamera> guessed = GuessCameras(options, *cameras);
  for (std::size_t c = 0; c < guessed.size(); ++c) {
    const Disagreement why = WhyViewsDisagree(target, options, (*cameras)[c], guessed[c].guess);
    if (why.lens) {
      (*cameras)[c] = PosedAgain(std::move((*cameras)[c]), *why.lens, target);
      guessed[c] = std::move(GuessCameras(options, {(*cameras)[c]}).front());
    }
    CameraReport& report = guessed[c].views.report;
    report.contradiction = why.contradiction;
    report.causes = why.causes;
  }
  return guessed;
}

}  // namespace

CalibratedCameras CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras) {
  return CalibrateWithLidars(target, options, std::move(cameras), {});
}

namespace {

CalibratedCameras CalibrateAsTheyAre(const Target& target, const CalibrateOptions& options,
                                     std::vector<CameraViews> cameras,
                                     std::vector<LidarViews> lidars) {
  CalibratedCameras out;
  CalibrateOptions pairing = options;
  pairing.first_guess.accept = kVotingGate;  // what contradicts the rest is found by the solve
  std::vector<GuessedCamera> guessed = GuessOrSayWhyNot(target, pairing, &cameras);
  out.rough_encoder_delay = RoughEncoderDelay(guessed);
  out.mount_breaks = LikeliestBreaks(guessed);
  for (const std::vector<std::size_t>& group : GroupsOf(guessed, options.joint)) {
    std::vector<GuessedCamera> together;
    std::vector<CameraViews> detected;
    together.reserve(group.size());
    for (const std::size_t c : group) {
      together.push_back(std::move(guessed[c]));
      detected.push_back(cameras[c]);
    }
    SolvedGroup solved = SolveGroup(target, pairing, std::move(together), detected, lidars);
    if (!lidars.empty()) out.lidars = std::move(solved.lidars);
    lidars.clear();  // the first group has them
    for (std::size_t i = 0; i < group.size(); ++i) guessed[group[i]] = std::move(solved.cameras[i]);
    for (MountChange& change : solved.changes) {
      out.changes.push_back({group[change.from], group[change.to], std::move(change.moved)});
    }
    out.next_view = Worse(std::move(out.next_view), std::move(solved.next_view));
    out.encoder_delay = SurerOf(std::move(out.encoder_delay), std::move(solved.encoder_delay));
  }
  for (LidarViews& left : lidars) out.lidars.push_back(WithoutCamera(std::move(left.report)));
  if (options.diagnostics) out.closure = CloseLoops(guessed);
  out.cameras = WithoutGuesses(std::move(guessed));
  return out;
}

}  // namespace

CalibratedCameras CalibrateWithLidars(const Target& target, const CalibrateOptions& options,
                                      std::vector<CameraViews> cameras,
                                      std::vector<LidarViews> lidars) {
  CalibrateOptions poses_alone = options;
  poses_alone.diagnostics = false;
  poses_alone.min_views = 2;
  return CalibrateWithoutEncoderDelay([&](double delay_s) {
    std::vector<CameraViews> turned = cameras;
    for (CameraViews& camera : turned) camera = WithoutEncoderDelay(std::move(camera), delay_s);
    CalibratedCameras found = CalibrateAsTheyAre(target, options, turned, lidars);
    if (!options.diagnostics) return found;
    return WithMovedMountNamed(std::move(found), turned, [&](std::vector<CameraViews> split) {
      return CalibrateAsTheyAre(target, poses_alone, std::move(split), {});
    });
  });
}

}  // namespace rgbdt
