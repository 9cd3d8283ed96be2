#include "calib/solve/internal/joint_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/solve/internal/evidence.h"
#include "calib/solve/internal/range_terms.h"
#include "calib/solve/internal/view_scatter.h"

namespace rgbdt {
namespace {

constexpr double kChanceChi2 = 30;  // six degrees of freedom: 4 in 100,000 lie beyond
constexpr double kMedianChi2 = 5.348;
constexpr double kSideSigmas = 4;
const char* const kSideNames[] = {"top", "right", "bottom", "left"};

using Index = Eigen::Index;

// What views scatter more than stated, as a factor of variance; the median is not moved by a few
// that are wrong.
double ScatterOf(const std::vector<Contradiction>& contradictions) {
  if (contradictions.size() < 3) return 1;
  std::vector<double> chi2;
  chi2.reserve(contradictions.size());
  for (const Contradiction& c : contradictions) chi2.push_back(c.chi2);
  std::sort(chi2.begin(), chi2.end());
  return std::max(1.0, chi2[chi2.size() / 2] / kMedianChi2);
}

// Images left of a camera.
int ImagesOf(const BoardProblem& problem, int camera) {
  int count = 0;
  for (const BoardView& view : problem.views) {
    for (const BoardImage& image : view.images) count += image.camera == camera ? 1 : 0;
  }
  return count;
}

const Contradiction* WorstToReject(const JointProblem& joint,
                                   const std::vector<Contradiction>& contradictions,
                                   const std::vector<int>& at_first) {
  const double limit = kChanceChi2 * ScatterOf(contradictions);
  const Contradiction* worst = nullptr;
  for (const Contradiction& c : contradictions) {
    const int camera = joint.problem.views[c.view].images[c.image].camera;
    const int left = ImagesOf(joint.problem, camera);
    if (left <= 3 || 3 * (left - 1) < 2 * at_first[static_cast<std::size_t>(camera)]) continue;
    if (c.chi2 > limit && (worst == nullptr || c.chi2 > worst->chi2)) worst = &c;
  }
  return worst;
}

// How far sides differ among themselves, by the data: never less than the physics says. The shifts
// as found, over how many of them the data tell (MacKay 1992).
double SideSigma(const JointProblem& joint, const BoardSolution& solution) {
  const double prior = joint.problem.priors.side_sigma_rad;
  double sum = 0;
  double told = 0;
  for (std::size_t v = 0; v < joint.problem.views.size(); ++v) {
    for (std::size_t side = 0; side < 4; ++side) {
      if (!joint.problem.views[v].sides[side]) continue;
      const double shift = solution.state.side_shift[v][side];
      sum += shift * shift;
      told += 1 - solution.side_variance[v][side] / (prior * prior);
    }
  }
  const double least = BoardPriors().side_sigma_rad;
  return told > 1 ? std::max(least, std::sqrt(sum / told)) : least;
}

// The range offset as the views have it, as if nothing had been known of it: one step from the
// solution.
Estimate FreeRangeOffset(const JointProblem& joint, const BoardSolution& solution) {
  const Index at = SharedPlaces(joint.problem).Of(kRangeOffset);
  const double offset = solution.state.shared[kRangeOffset];
  ViewInformation all = PriorInformation(joint.problem, solution.state);
  all.information(at, at) = 1 / (kRangeOffsetSigmaM * kRangeOffsetSigmaM);
  all.gradient[at] = -offset * all.information(at, at);
  for (const ViewInformation& view : solution.views) {
    all.information += view.information;
    all.gradient += view.gradient;
  }
  const Eigen::MatrixXd covariance = InverseOfSymmetric(all.information);
  const Eigen::VectorXd step = covariance * all.gradient;
  return {offset + step[at], std::sqrt(covariance(at, at))};
}

// How far the board's sides in the images lie from where the rest puts them, beyond what their own
// fits say: boards are not quite straight, and show their rims. Robust, as what contradicts the
// rest is still among them; nothing where chance may make as much.
double ImageSideSigma(const BoardProblem& problem, const BoardState& state) {
  std::vector<double> off;
  std::vector<double> sigma;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    for (const ImageSideEnd& end : ImageSideEnds(problem, state, v)) {
      off.push_back(std::abs(end.beside_m));
      sigma.push_back(end.sigma_m);
    }
  }
  if (off.size() < 16) return 0;
  const double scatter = Median(std::move(off)) / 0.6745;
  const double stated = Median(std::move(sigma));
  return scatter * scatter > 2 * stated * stated ? std::sqrt(scatter * scatter - stated * stated)
                                                 : 0;
}

// Solves, and again without what contradicts the rest.
class JointSolver {
 public:
  explicit JointSolver(JointProblem joint) : state_(joint.start) {
    result_.joint = std::move(joint);
    for (std::size_t c = 0; c < Joint().cameras.size(); ++c) {
      images_at_first_.push_back(ImagesOf(Problem(), static_cast<int>(c)));
    }
  }

  JointResult Solve() {
    SolveOnce();
    PoseImagesAgain();
    FitImageSides();
    FitRanges();
    FitScatter();  // before views are judged by it
    for (std::size_t round = 0; round < 4 * Problem().views.size() + 4; ++round) {
      SolveOnce();
      const auto contradictions = Contradictions(Problem(), result_.solution);
      const Contradiction* worst = WorstToReject(Joint(), contradictions, images_at_first_);
      if (worst != nullptr) {
        RejectImage(*worst);
        continue;
      }
      if (DropSide()) continue;
      FitScatter();
      Settle();
      result_.view_scatter = ViewScatterOf(Problem(), result_.solution);
      if (const auto& scatter = result_.view_scatter) {
        result_.variance_factor = FactorFor(
            scatter->factor, scatter->freedom,
            AsStated(Contradictions(Problem(), result_.solution), Problem().views.size()));
      }
      break;
    }
    return std::move(result_);
  }

 private:
  JointProblem& Joint() { return result_.joint; }
  BoardProblem& Problem() { return result_.joint.problem; }

  // As exactly as it takes to decide what to solve next: to a tenth of a sigma.
  void SolveOnce() {
    constexpr double kSettled = 1e-2;
    result_.solution = SolveBoards(Problem(), state_, kSettled);
    state_ = result_.solution.state;
  }

  void Settle() {
    result_.solution = SolveBoards(Problem(), state_);
    state_ = result_.solution.state;
  }

  // With the lenses and the print that a first solve finds: where these are wrong, corners seem
  // worse than they are.
  void PoseImagesAgain() {
    const auto& priors = Problem().lens_priors;
    const bool printed = Problem().target.print_sigma == 0;
    const Target target = PrintedAs(Problem().target, state_.shared);
    for (std::size_t c = 0; c < Joint().cameras.size(); ++c) {
      if (priors[c].isZero(0) && printed) continue;
      CameraViews& views = Joint().cameras[c].views;
      views = PosedAgain(std::move(views), state_.lenses[c], target);
    }
    for (BoardView& view : Problem().views) {
      for (BoardImage& image : view.images) {
        const CameraViews& views = Joint().cameras[static_cast<std::size_t>(image.camera)].views;
        image.edges = views.Find(view.name)->image;
      }
    }
  }

  // Solves again until the sigma of sides in images agrees with them.
  void FitImageSides() {
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      double& sigma = Problem().priors.image_side_sigma_m;
      const double now = ImageSideSigma(Problem(), state_);
      if (!(std::abs(now - sigma) > 0.05 * sigma)) return;
      sigma = now;
      SolveOnce();
    }
  }

  void RejectImage(const Contradiction& worst) {
    BoardView& view = Problem().views[worst.view];
    const int camera = view.images[worst.image].camera;
    const int others = ImagesOf(Problem(), camera) - 1;
    for (CameraView& o : Joint().cameras[static_cast<std::size_t>(camera)].views.all) {
      if (o.view != view.name) continue;
      o.Reject("contradicts the other " + std::to_string(others) +
               " views: by itself it would put the camera " + Fixed(worst.rotation_deg, 2) +
               " deg and " + Fixed(worst.centre_mm, 0) +
               " mm elsewhere; did board or rig move, or does something stand against the board?");
    }
    view.images.erase(view.images.begin() + static_cast<std::ptrdiff_t>(worst.image));
    if (!view.images.empty()) return;
    const auto at = static_cast<std::ptrdiff_t>(worst.view);
    Problem().views.erase(Problem().views.begin() + at);
    state_.lidar_from_target.erase(state_.lidar_from_target.begin() + at);
    state_.side_shift.erase(state_.side_shift.begin() + at);
  }

  // The side whose own shift is the least likely, out. False: none is unlikely enough.
  bool DropSide() {
    const double most = kSideSigmas * Problem().priors.side_sigma_rad;
    double worst = most;
    std::size_t view = 0;
    std::size_t side = 0;
    for (std::size_t v = 0; v < Problem().views.size(); ++v) {
      for (std::size_t s = 0; s < 4; ++s) {
        // A rectangle needs three.
        const auto& sides = Problem().views[v].sides;
        if (!sides[s] || std::count(sides.begin(), sides.end(), true) < 4) continue;
        const double shift = std::abs(state_.side_shift[v][s]);
        if (shift <= worst) continue;
        worst = shift;
        view = v;
        side = s;
      }
    }
    if (worst <= most) return false;
    Problem().views[view].sides[side] = false;
    for (const BoardImage& image : Problem().views[view].images) {
      Joint().cameras[static_cast<std::size_t>(image.camera)].views.report.warnings.push_back(
          "view " + Problem().views[view].name + ": the board's " + kSideNames[side] +
          " side in the cloud lies " + Fixed(worst * 1000, 1) +
          " mrad from where the other sides put it; that side is left out, the view is used");
    }
    return true;
  }

  // Solves again until what ranges are off by agrees with the views.
  void FitRanges() {
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      if (!FitRangeTerms(result_.solution, &Problem(), &state_)) return;
      SolveOnce();
    }
  }

  // Solves again until the sigmas of what differs by view and side agree with the views.
  void FitScatter() {
    constexpr int kRounds = 12;
    for (int round = 0; round < kRounds; ++round) {
      const double before = Problem().priors.side_sigma_rad;
      const double now = SideSigma(Joint(), result_.solution);
      const bool sides = std::abs(now - before) > 0.03 * before;
      if (sides) Problem().priors.side_sigma_rad = now;
      const bool ranges = FitRangeTerms(result_.solution, &Problem(), &state_);
      if (!sides && !ranges) return;
      SolveOnce();
    }
  }

  JointResult result_;
  BoardState state_;
  std::vector<int> images_at_first_;  // of each camera
};

std::vector<LensOff> LensesOff(const JointResult& result) {
  const SharedPlaces places(result.joint.problem);
  std::vector<LensOff> off;
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    const Index at = places.Lens(c);
    off.push_back(
        AgainstPrior(NumbersOf(result.solution.state.lenses[c]) -
                         NumbersOf(result.joint.problem.cameras[c].lens()),
                     result.joint.problem.lens_priors[c],
                     result.solution.covariance.block<kLensNumbers, kLensNumbers>(at, at)));
  }
  return off;
}

// With the range offset free where the views refute what is known of it.
JointResult SolveWithOffset(JointProblem joint) {
  const double known = joint.problem.priors.range_offset_sigma_m;
  // NaN, where the views say nothing, refutes nothing.
  const auto refuted = [&](const JointResult& result, double sigmas) {
    const Estimate free = FreeRangeOffset(result.joint, result.solution);
    const double sigma = std::sqrt(result.variance_factor) * free.sigma;
    return std::abs(free.value) > sigmas * std::hypot(sigma, known);
  };
  if (known >= kRangeOffsetSigmaM || !joint.problem.target.HasPattern()) {
    return JointSolver(std::move(joint)).Solve();
  }
  JointProblem open = joint;
  open.problem.priors.range_offset_sigma_m = kRangeOffsetSigmaM;
  open.problem.ranges_exact = false;
  OpenBeams(&open.problem);
  JointResult held = JointSolver(std::move(joint)).Solve();
  if (!refuted(held, 4)) return held;
  JointResult found = JointSolver(std::move(open)).Solve();
  // Views that contradict the rest then may have made it up.
  if (!refuted(found, 3)) return held;
  found.refuted_range_offset_sigma_m = known;
  return found;
}

}  // namespace

JointResult SolveJointly(JointProblem joint) {
  JointProblem wider = joint;
  JointResult result = SolveWithOffset(std::move(joint));
  result.lenses_off = LensesOff(result);
  bool contradicted = false;
  std::vector<LensCovariance> given = wider.problem.lens_priors;
  for (std::size_t c = 0; c < wider.cameras.size(); ++c) {
    const LensOff& off = result.lenses_off[c];
    if (!off.contradicts()) continue;
    // As little as of any lens, and as much worse than that as they say: numbers that were held
    // exactly, of a distortion left out, must move, too.
    const CameraSpec& spec = *wider.cameras[c].views.spec;
    LensCovariance& prior = wider.problem.lens_priors[c];
    prior += UsualLensUncertainty(spec.lens, spec.width, spec.height).covariance;
    prior *= off.chi2 / off.freedom;
    contradicted = true;
  }
  if (!contradicted) return result;
  JointResult again = SolveWithOffset(std::move(wider));
  again.lenses_off = std::move(result.lenses_off);
  for (std::size_t c = 0; c < again.joint.cameras.size(); ++c) {
    LensOff& off = again.lenses_off[c];
    off.off = NumbersOf(again.solution.state.lenses[c]) -
              NumbersOf(again.joint.problem.cameras[c].lens());
    off.covariance =
        given[c] + CovarianceOf(again, c).bottomRightCorner<kLensNumbers, kLensNumbers>();
  }
  return again;
}

Halves Apart(const BoardSolution& a, const BoardSolution& b, double variance_factor,
             std::size_t camera) {
  const Rigid3& pose_a = a.state.camera_from_lidar[camera];
  const Rigid3& pose_b = b.state.camera_from_lidar[camera];
  const Index at = SharedPlaces::Pose(camera);
  const Matrix6d covariance =
      variance_factor * (a.covariance.block<6, 6>(at, at) + b.covariance.block<6, 6>(at, at));
  const Vector6d delta = Log(pose_a * pose_b.Inverse());
  return {ErrorOf(pose_a, pose_b), delta.dot(SolveSymmetric(covariance, delta))};
}

PoseAndLensCovariance CovarianceOf(const JointResult& result, std::size_t index) {
  const PoseAndLensCovariance covariance =
      result.variance_factor *
      result.solution.PoseAndLens(SharedPlaces(result.joint.problem), index);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace rgbdt
