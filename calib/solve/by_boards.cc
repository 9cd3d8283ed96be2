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
#include "calib/solve/internal/given_wrong.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/next_view.h"

namespace rgbdt {
namespace {

struct NuisanceLine {
  SharedUnknown unknown;
  const char* name;
  const char* unit;  // of a thousandth of the unknown's own
};
constexpr NuisanceLine kNuisances[] = {
    {kNoReturnShift, "beam edge, nothing beyond", "mrad"},
    {kFarShift, "beam edge, far background", "mrad"},
    {kMergedShift, "beam edge, background just behind", "mrad"},
    {kThickness, "board's thickness", "mm"},
    {kOutlineTop, "board's top side, beyond its pattern", "mm"},
    {kOutlineRight, "board's right side, beyond its pattern", "mm"},
    {kOutlineBottom, "board's bottom side, beyond its pattern", "mm"},
    {kOutlineLeft, "board's left side, beyond its pattern", "mm"},
    {kRangeOffset, "range offset", "mm"},
    {kPrintWidth, "pattern's width, found less given", "mm/m"},
    {kPrintHeight, "pattern's height, found less given", "mm/m"},
    {kBeamsMeet, "radius at which the LIDAR's beams meet", "mm"},
    {kFringe, "beam edge, at any range", "mm"},
    {kBowX, "board's shape, its ends behind its middle along its width", "mm"},
    {kTwist, "board's shape, twist", "mm"},
    {kBowY, "board's shape, its ends behind its middle along its height", "mm"}};

// An unknown that all views share, with its sigma, the variance factor counted in.
Estimate EstimateOf(const JointResult& result, SharedUnknown unknown) {
  const auto at = SharedPlaces(result.joint.problem).Of(unknown);
  return {result.solution.state.shared[static_cast<std::size_t>(unknown)],
          std::sqrt(std::max(0.0, result.variance_factor * result.solution.covariance(at, at)))};
}

// How much single sides differ, which no class explains: the solve's own estimate, from so many
// sides.
std::optional<Nuisance> SideScatter(const JointProblem& joint) {
  double sides = 0;
  for (const BoardView& view : joint.problem.views) {
    sides += static_cast<double>(std::count(view.sides.begin(), view.sides.end(), true));
  }
  if (sides == 0) return std::nullopt;
  const double sigma = joint.problem.priors.side_sigma_rad;
  return Nuisance{"beam edge, scatter of single sides",
                  "mrad",
                  {1000 * sigma, 1000 * sigma / std::sqrt(2 * sides)}};
}

// How much rings differ within a view, beyond their points' noise.
std::optional<Nuisance> ScatterOfRings(const JointProblem& joint) {
  const double sigma = joint.problem.priors.ring_view_sigma_m;
  double rings = 0;
  for (const BoardView& view : joint.problem.views) {
    rings += static_cast<double>(view.cloud.groups.size());
  }
  if (!(sigma > 0)) return std::nullopt;
  return Nuisance{"rings' ranges, scatter within a view",
                  "mm",
                  {1000 * sigma, 1000 * sigma / std::sqrt(2 * std::max(1.0, rings))}};
}

// The lens's focal lengths and centre, as found less as given.
std::vector<Nuisance> LensLines(const JointResult& result, std::size_t camera) {
  constexpr const char* kLines[] = {"lens: focal length fx, found less given", "lens: fy",
                                    "lens: centre cx", "lens: cy"};
  if (result.joint.problem.lens_priors[camera].isZero(0)) return {};
  const PoseAndLensCovariance covariance = CovarianceOf(result, camera);
  const LensNumbers off = NumbersOf(result.solution.state.lenses[camera]) -
                          NumbersOf(result.joint.problem.cameras[camera].lens());
  std::vector<Nuisance> lines;
  for (Eigen::Index i = 0; i < 4; ++i) {
    lines.push_back({kLines[i], "px", {off[i], std::sqrt(covariance(6 + i, 6 + i))}});
  }
  return lines;
}

std::vector<Nuisance> NuisancesOf(const JointResult& result, std::size_t camera) {
  std::vector<Nuisance> nuisances;
  for (const NuisanceLine& line : kNuisances) {
    const Estimate estimate = EstimateOf(result, line.unknown);
    // Where the prior's sigma is left, the data say nothing of it.
    if (estimate.sigma > 0.98 * result.joint.problem.priors.Sigma(line.unknown)) continue;
    nuisances.push_back({line.name, line.unit, {1000 * estimate.value, 1000 * estimate.sigma}});
  }
  if (auto scatter = SideScatter(result.joint)) nuisances.push_back(*scatter);
  if (auto scatter = ScatterOfRings(result.joint)) nuisances.push_back(*scatter);
  for (Nuisance& line : LensLines(result, camera)) nuisances.push_back(std::move(line));
  return nuisances;
}

// An offset of one of the problem's terms, with its sigma, the variance factor counted in.
Estimate TermOf(const JointResult& result, std::size_t term) {
  const Eigen::Index at = SharedPlaces(result.joint.problem).RangeTerm(term);
  return {result.solution.state.range_terms[term],
          std::sqrt(std::max(0.0, result.variance_factor * result.solution.covariance(at, at)))};
}

// Nothing where the LIDAR was taken for exact.
std::optional<RangeErrors> RangeErrorsOf(const JointResult& result) {
  const BoardPriors& priors = result.joint.problem.priors;
  const RangeTerms& terms = result.joint.problem.ranges;
  RangeErrors errors;
  const bool offset = priors.range_offset_sigma_m > kNoRangeOffsetSigmaM;
  const bool meet = priors.beams_meet_sigma_m > kNoBeamsMeetSigmaM;
  if (!offset && !meet && terms.Count() == 0) return std::nullopt;
  if (offset) errors.offset_m = EstimateOf(result, kRangeOffset);
  if (meet) errors.beams_meet_m = EstimateOf(result, kBeamsMeet);
  for (std::size_t i = 0; i < terms.rings.size(); ++i) {
    errors.rings.push_back({terms.rings[i], TermOf(result, i)});
  }
  for (std::size_t i = 0; i < terms.octaves; ++i) {
    errors.intensities.push_back(
        {terms.first_octave + static_cast<double>(i), TermOf(result, terms.rings.size() + i)});
  }
  return errors;
}

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

std::string RangesAreOff(const Estimate& offset, double known_m) {
  return Format(
      "the LIDAR's ranges are %.1f +- %.1f mm too %s; the rig file has them exact to %.1f "
      "mm (lidar.range_offset_sigma_m). The views decided. Check the ranges against a tape "
      "measure, and raise that number",
      1000 * std::abs(offset.value), 1000 * offset.sigma, offset.value > 0 ? "short" : "long",
      1000 * known_m);
}

// A camera's report with what the joint solve found, which took `seconds`.
CameraReport WithSolution(const JointResult& result, std::size_t camera, double seconds) {
  CameraReport report = result.joint.cameras[camera].views.report;
  report.calibration = CalibrationOf(result, camera);
  report.nuisance = NuisancesOf(result, camera);
  report.view_scatter = result.view_scatter;
  report.variance_factor = result.variance_factor;
  if (result.refuted_range_offset_sigma_m) {
    report.warnings.push_back(RangesAreOff(report.calibration.range_errors->offset_m,
                                           *result.refuted_range_offset_sigma_m));
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
    const Matrix6d together =
        result.variance_factor *
        result.solution.covariance.block<6, 6>(SharedPlaces::Pose(c), SharedPlaces::Pose(first));
    changes.push_back(
        {first, c, Compare(from.report.calibration, to.report.calibration, to.spec, together)});
  }
  return changes;
}

// Cameras that were solved together, and where to hold the board next.
struct SolvedGroup {
  std::vector<GuessedCamera> cameras;
  std::vector<MountChange> changes;  // indices into `cameras`
  std::optional<NextView> next_view;
};

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
                               const std::vector<CameraViews>& detected) {
  const double offset_sigma_m = options.first_guess.range_offset_sigma_m;
  JointResult result = SolveJointly(MakeJointProblem(target, std::move(cameras), offset_sigma_m));
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
  JointResult again = SolveJointly(MakeJointProblem(target, std::move(guessed), offset_sigma_m));
  return ImagesUsed(again) < ImagesUsed(result) ? std::move(result) : std::move(again);
}

SolvedGroup SolveGroup(const Target& target, const CalibrateOptions& options,
                       std::vector<GuessedCamera> cameras,
                       const std::vector<CameraViews>& detected) {
  const Stopwatch watch;
  JointResult result = SolveWithLensFound(target, options, std::move(cameras), detected);
  const double seconds = watch.Seconds();
  std::vector<std::vector<Cause>> causes = GivenWrong(result);
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    CameraReport& report = result.joint.cameras[c].views.report;
    report = WithSolution(result, c, seconds);
    report.causes = std::move(causes[c]);
  }
  result = HoldEdgesAgainstPlanes(std::move(result));
  SolvedGroup solved;
  solved.changes = ChangesOf(result);
  if (options.diagnostics) {
    result = CrossValidate(std::move(result), options.folds);
    // Of a session that is over there is no next view.
    if (solved.changes.empty()) solved.next_view = FindNextView(result);
  }
  const EdgeModel edges = EdgesOf(result);
  solved.cameras = std::move(result.joint.cameras);
  for (GuessedCamera& camera : solved.cameras) {
    camera.views = Judged(edges, std::move(camera.views));
  }
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

// Of cameras that are solved apart, the worst one's.
std::optional<NextView> Worse(std::optional<NextView> a, std::optional<NextView> b) {
  return b && (!a || b->sigma_before_px > a->sigma_before_px) ? std::move(b) : std::move(a);
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
  CalibratedCameras out;
  CalibrateOptions pairing = options;
  pairing.first_guess.accept = kVotingGate;  // what contradicts the rest is found by the solve
  std::vector<GuessedCamera> guessed = GuessOrSayWhyNot(target, pairing, &cameras);
  for (const std::vector<std::size_t>& group : GroupsOf(guessed, options.joint)) {
    std::vector<GuessedCamera> together;
    std::vector<CameraViews> detected;
    together.reserve(group.size());
    for (const std::size_t c : group) {
      together.push_back(std::move(guessed[c]));
      detected.push_back(cameras[c]);
    }
    SolvedGroup solved = SolveGroup(target, pairing, std::move(together), detected);
    for (std::size_t i = 0; i < group.size(); ++i) guessed[group[i]] = std::move(solved.cameras[i]);
    for (MountChange& change : solved.changes) {
      out.changes.push_back({group[change.from], group[change.to], std::move(change.moved)});
    }
    out.next_view = Worse(std::move(out.next_view), std::move(solved.next_view));
  }
  if (options.diagnostics) out.closure = CloseLoops(guessed);
  out.cameras = WithoutGuesses(std::move(guessed));
  return out;
}

}  // namespace rgbdt
