#include "calib/solve/internal/joint_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/solve/internal/encoder_delay.h"
#include "calib/solve/internal/evidence.h"
#include "calib/solve/internal/further_lidars.h"
#include "calib/solve/internal/held_offsets.h"
#include "calib/solve/internal/lens_by_images.h"
#include "calib/solve/internal/lenses_off.h"
#include "calib/solve/internal/range_terms.h"
#include "calib/solve/internal/scatter_sigmas.h"
#include "calib/solve/internal/swap_reference.h"
#include "calib/solve/internal/view_scatter.h"

namespace rgbdt {
namespace {

constexpr double kMedianChi2 = 5.348;
constexpr double kToDecide = 1e-2;  // a tenth of a sigma

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

// How many images are left of a camera.
int ImagesOf(const BoardProblem& problem, int camera) {
  int count = 0;
  for (const BoardView& view : problem.views) {
    for (const BoardImage& image : view.images) count += image.camera == camera ? 1 : 0;
  }
  return count;
}

// Of each camera, then of each further LIDAR.
std::vector<int> ViewsOfSensors(const BoardProblem& problem) {
  std::vector<int> views;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    views.push_back(ImagesOf(problem, static_cast<int>(c)));
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) views.push_back(CloudsOf(problem, l));
  return views;
}

// Whether a camera, or a further LIDAR, has enough views to lose this one's.
class MayLose {
 public:
  MayLose(const BoardProblem& problem, const std::vector<int>& at_first)
      : problem_(problem), at_first_(at_first), now_(ViewsOfSensors(problem)) {}

  bool operator()(const Contradiction& c) const {
    const std::size_t sensor = SensorOf(problem_, c);
    return now_[sensor] > 3 && 3 * (now_[sensor] - 1) >= 2 * at_first_[sensor];
  }

 private:
  const BoardProblem& problem_;
  const std::vector<int>& at_first_;
  std::vector<int> now_;
};

// How far the other views scatter among themselves.
double ScatterWithout(const BoardProblem& problem, const BoardSolution& solution,
                      std::size_t left_out) {
  std::vector<std::size_t> others;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (v != left_out) others.push_back(v);
  }
  const BoardSolution rest = SolveSome(problem, solution, others);
  return ScatterOf(Contradictions(Part(problem, others, solution.state).problem, rest));
}

// A view that is far off draws the result so far away from all others that these seem to scatter as
// much: each of the worst is held against what the others scatter without it.
const Contradiction* WorstBehindItsMask(const BoardProblem& problem, const BoardSolution& solution,
                                        double scatter,
                                        std::vector<const Contradiction*> beyond_chance) {
  constexpr std::size_t kMostTried = 4;  // views
  constexpr double kUnmasked = 0.5;      // of the scatter: what a mask hides is more than it leaves
  std::sort(beyond_chance.begin(), beyond_chance.end(),
            [](const Contradiction* a, const Contradiction* b) { return a->chi2 > b->chi2; });
  const Contradiction* worst = nullptr;
  double most = kContradictionChi2;
  std::vector<std::size_t> tried;
  for (const Contradiction* c : beyond_chance) {
    if (std::find(tried.begin(), tried.end(), c->view) != tried.end()) continue;
    if (tried.size() == kMostTried) break;
    tried.push_back(c->view);
    const double without = ScatterWithout(problem, solution, c->view);
    const double times = c->chi2 / without;
    if (without > kUnmasked * scatter || times <= most) continue;
    most = times;
    worst = c;
  }
  return worst;
}

const Contradiction* WorstToReject(const BoardProblem& problem, const BoardSolution& solution,
                                   const std::vector<Contradiction>& contradictions,
                                   const std::vector<int>& at_first) {
  const MayLose may_lose(problem, at_first);
  const double scatter = ScatterOf(contradictions);
  const double limit = kContradictionChi2 * scatter;
  const Contradiction* worst = nullptr;
  std::vector<const Contradiction*> beyond_chance;
  for (const Contradiction& c : contradictions) {
    if (!(c.chi2 > kContradictionChi2) || !may_lose(c)) continue;
    beyond_chance.push_back(&c);
    if (c.chi2 > limit && (worst == nullptr || c.chi2 > worst->chi2)) worst = &c;
  }
  return worst != nullptr ? worst : WorstBehindItsMask(problem, solution, scatter, beyond_chance);
}

// Solves, and again without what contradicts the rest.
class JointSolver {
 public:
  explicit JointSolver(JointProblem joint) : state_(joint.start) {
    result_.joint = std::move(joint);
    views_at_first_ = ViewsOfSensors(Problem());
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
      const Contradiction* worst =
          WorstToReject(Problem(), result_.solution, contradictions, views_at_first_);
      if (worst != nullptr) {
        if (worst->lidar) {
          RejectCloud(*worst, &Joint());
        } else {
          RejectImage(*worst);
        }
        continue;
      }
      if (DropSide() || DropFurtherSide()) continue;
      FitScatter();
      Settle();
      JudgeScatter();
      break;
    }
    return std::move(result_);
  }

 private:
  JointProblem& Joint() { return result_.joint; }
  BoardProblem& Problem() { return result_.joint.problem; }

  // As exactly as it takes to decide what to solve next: to a tenth of a sigma.
  void SolveOnce() {
    result_.solution = SolveBoards(Problem(), state_, kToDecide);
    state_ = result_.solution.state;
  }

  void Settle() {
    result_.solution = SolveBoards(Problem(), state_);
    state_ = result_.solution.state;
  }

  // With the lenses, the print and the board's shape that a first solve finds: where these are
  // wrong, corners seem worse than they are.
  void PoseImagesAgain() {
    const auto& priors = Problem().lens_priors;
    const bool printed = Problem().target.print_sigma == 0;
    const Target target = PrintedAs(Problem().target, state_.shared);
    for (std::size_t c = 0; c < Joint().cameras.size(); ++c) {
      if (priors[c].isZero(0) && printed) continue;
      CameraViews& views = Joint().cameras[c].views;
      views = PosedAgain(std::move(views), state_.lenses[c], target, BowOf(state_.shared));
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

  // By how much variances are enlarged: the cameras' together, each further LIDAR's by itself, as
  // one of few views moves far more than the rest.
  void JudgeScatter() {
    const auto contradictions = Contradictions(Problem(), result_.solution);
    const auto factor = [&](const std::optional<ViewScatter>& scatter,
                            std::optional<std::size_t> lidar, std::size_t views) {
      if (!scatter) return 1.0;
      std::vector<Contradiction> own;
      for (const Contradiction& c : contradictions) {
        if (c.lidar == lidar) own.push_back(c);
      }
      return FactorFor(scatter->factor, scatter->freedom, AsStated(own, views));
    };
    result_.placements = PlacementsOf(result_.solution.state.lidar_from_target);
    result_.view_scatter = ViewScatterOf(Problem(), result_.solution);
    result_.variance_factor = factor(result_.view_scatter, std::nullopt, Problem().views.size());
    result_.lidar_factors.clear();
    for (std::size_t l = 0; l < Problem().lidars.size(); ++l) {
      result_.lidar_factors.push_back(factor(ViewScatterOf(Problem(), result_.solution, l), l,
                                             static_cast<std::size_t>(CloudsOf(Problem(), l))));
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
    for (std::size_t l = 0; l < state_.lidars.size(); ++l) {
      if (HasCloud(Problem(), l, worst.view)) {
        Joint().lidars[l].report.rejected.push_back(
            {Problem().lidars[l].views[worst.view].name, "no camera's image of the view was used"});
      }
      Problem().lidars[l].views.erase(Problem().lidars[l].views.begin() + at);
      state_.lidars[l].side_shift.erase(state_.lidars[l].side_shift.begin() + at);
    }
  }

  // The side whose own shift is the least likely, out. False: none is unlikely enough.
  bool DropSide() {
    const auto side = LeastLikelySide(Problem(), state_.side_shift);
    if (!side) return false;
    BoardView& view = Problem().views[side->view];
    view.sides[side->side] = false;
    for (const BoardImage& image : view.images) {
      Joint().cameras[static_cast<std::size_t>(image.camera)].views.report.warnings.push_back(
          SideIsOut(view.name, *side));
    }
    return true;
  }

  // The same of the further LIDARs' clouds.
  bool DropFurtherSide() {
    for (std::size_t l = 0; l < state_.lidars.size(); ++l) {
      const auto side = LeastLikelySide(Problem().lidars[l], state_.lidars[l].side_shift);
      if (!side) continue;
      BoardView& view = Problem().lidars[l].views[side->view];
      view.sides[side->side] = false;
      Joint().lidars[l].report.warnings.push_back(SideIsOut(view.name, *side));
      return true;
    }
    return false;
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
      bool changed = FitScatterOnce(result_.solution);
      // Each further LIDAR's as if it were the reference.
      for (std::size_t l = 0; l < state_.lidars.size(); ++l) {
        SwapReference(l, &Problem(), &state_);
        changed = FitScatterOnce(SolveBoards(Problem(), state_, kToDecide)) || changed;
        SwapReference(l, &Problem(), &state_);
      }
      if (!changed) return;
      SolveOnce();
    }
  }

  // Of the reference's clouds at a solution: whether anything changed.
  bool FitScatterOnce(const BoardSolution& solution) {
    const double before = Problem().priors.side_sigma_rad;
    const double now = SideSigma(Problem(), solution);
    const bool sides = std::abs(now - before) > 0.03 * before;
    if (sides) Problem().priors.side_sigma_rad = now;
    return FitRangeTerms(solution, &Problem(), &state_) || sides;
  }

  JointResult result_;
  BoardState state_;
  std::vector<int> views_at_first_;  // as ViewsOfSensors
};

// With the range offsets free that the views refute what is known of.
JointResult SolveWithOffset(JointProblem joint) {
  const std::vector<RefutedOffset> held = HeldOffsets(joint.problem);
  if (held.empty()) return JointSolver(std::move(joint)).Solve();
  JointProblem open = joint;
  JointResult found = JointSolver(std::move(joint)).Solve();
  const std::vector<RefutedOffset> refuted = RefutedOf(held, found, 4);
  if (refuted.empty()) return found;
  for (const RefutedOffset& offset : refuted) {
    FreeOffset(offset, &open.problem);
  }
  JointResult free = JointSolver(std::move(open)).Solve();
  // Views that contradict the rest then may have made it up.
  if (RefutedOf(refuted, free, 3).size() < refuted.size()) return found;
  free.refuted_offsets = refuted;
  return free;
}

LensCovariance UsualPrior(const CameraSpec& camera) {
  return UsualLensUncertainty(camera.lens, camera.width, camera.height).covariance;
}

// Where the views scatter far beyond noise and a camera's images alone contradict its lens, which
// was taken for exact: all is solved with such lenses as uncertain as any.
void OpenExactLenses(JointProblem* joint, JointResult* result) {
  constexpr double kCannotBe = 6;  // of variance
  if (!result->view_scatter || !(result->view_scatter->factor > kCannotBe)) return;
  bool open = false;
  for (std::size_t c = 0; c < joint->cameras.size(); ++c) {
    if (!joint->problem.HasOwnLens(c) || !joint->problem.lens_priors[c].isZero(0)) continue;
    const CameraViews& views = joint->cameras[c].views;
    const auto lens = FindLensByImages(joint->problem.target, views);
    if (!lens || !ImagesRefute(*lens, views.spec->lens)) continue;
    joint->problem.lens_priors[c] = UsualPrior(*views.spec);
    open = true;
  }
  if (open) *result = SolveWithOffset(*joint);
}

Halves ApartBy(const Rigid3& a, const Rigid3& b, const Matrix6d& covariance) {
  const Vector6d delta = Log(a * b.Inverse());
  return {ErrorOf(a, b), delta.dot(SolveSymmetric(covariance, delta))};
}

}  // namespace

JointResult SolveJointly(JointProblem joint) {
  const std::vector<LensCovariance> given = joint.problem.lens_priors;
  JointProblem wider = joint;
  JointResult result = SolveWithOffset(std::move(joint));
  OpenExactLenses(&wider, &result);
  std::vector<LensOff> off = LensesOff(result);
  bool contradicted = false;
  for (std::size_t c = 0; c < wider.cameras.size(); ++c) {
    if (!off[c].contradicts()) continue;
    // As little as of any lens, and as much worse than that as they say: numbers that were held
    // exactly, of a distortion left out, must move, too.
    LensCovariance& prior = wider.problem.lens_priors[c];
    prior += UsualPrior(*wider.cameras[c].views.spec);
    prior *= off[c].chi2 / off[c].freedom;
    contradicted = true;
  }
  if (contradicted) result = SolveWithOffset(std::move(wider));
  result.lenses_off = AgainstGiven(result, given, std::move(off));
  result.encoder_delay = EncoderDelayOf(result);
  return result;
}

Halves Apart(const BoardSolution& a, const BoardSolution& b, double variance_factor,
             std::size_t camera) {
  const Index at = SharedPlaces::Pose(camera);
  return ApartBy(
      a.state.camera_from_lidar[camera], b.state.camera_from_lidar[camera],
      variance_factor * (a.covariance.block<6, 6>(at, at) + b.covariance.block<6, 6>(at, at)));
}

Halves LidarApart(const BoardSolution& a, const BoardSolution& b, const JointResult& result,
                  std::size_t lidar) {
  const Index at = SharedPlaces(result.joint.problem).LidarPose(lidar);
  return ApartBy(a.state.lidars[lidar].reference_from_lidar,
                 b.state.lidars[lidar].reference_from_lidar,
                 result.lidar_factors[lidar] *
                     (a.covariance.block<6, 6>(at, at) + b.covariance.block<6, 6>(at, at)));
}

JointResult WithoutLidars(JointResult result) {
  if (result.joint.problem.lidars.empty()) return result;
  result.joint.problem.lidars.clear();
  result.joint.start.lidars.clear();
  result.joint.lidars.clear();
  result.lidar_factors.clear();
  BoardState state = std::move(result.solution.state);
  state.lidars.clear();
  result.solution = SolveBoards(result.joint.problem, state);
  return result;
}

PoseAndLensCovariance CovarianceOf(const JointResult& result, std::size_t index) {
  const SharedPlaces places(result.joint.problem);
  PoseAndLensCovariance covariance =
      result.PoseFactor() * result.solution.PoseAndLens(places, index);
  if (result.encoder_delay) {
    Eigen::Matrix<double, kPoseAndLens, 1> move;
    Index i = 0;
    for (const Index at : places.PoseAndLens(index)) {
      move[i++] = result.encoder_delay->unknown_move[at];
    }
    covariance += move * move.transpose();
  }
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace rgbdt
