#include "calib/methods/natural/by_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kCoarsestSigmaPx = 5;  // of a level's pixels
constexpr int kFineReachPx = 8;
// Of a source's edges: fewer are shown by chance, too.
constexpr double kLeastShown = 0.15;
// Sigma of an image edge about its rim: what lies outside of these is chance that was learned.
constexpr double kLeastEdgePx = 0.6, kMostEdgePx = 2.5;
constexpr double kLeastStepRad = 0.01, kMostStepRad = 0.035;  // between turned starts
constexpr std::size_t kTried = 8, kKept = 4;  // of poses that are looked at side by side

// Information of numbers of which those with a variance of zero are exact.
template <int N>
Eigen::Matrix<double, N, N> InformationOf(Eigen::Matrix<double, N, N> covariance) {
  constexpr double kExact = 1e12;
  for (Eigen::Index k = 0; k < N; ++k) {
    if (covariance(k, k) <= 0) covariance(k, k) = 1 / kExact;
    covariance(k, k) *= 1 + 1e-9;  // those that are made of each other are still inverted
  }
  return InverseOfSymmetric(covariance);
}

class Solver {
 public:
  Solver(const SceneProblem& problem, const Rigid3& start, const NaturalOptions& options)
      : problem_(problem) {
    start_.camera_from_lidar = start;
    start_.lens = problem.spec().lens;
    prior_.setZero();
    PoseAndLensCovariance known = WithExactLens(options.StartCovariance());
    known.bottomRightCorner<kLensNumbers, kLensNumbers>() =
        problem.spec().LensUncertaintyOrUsual().covariance;
    const PoseAndLensCovariance information =
        InformationOf<kPoseAndLens>(options.start_covariance.value_or(known));
    prior_.topLeftCorner<6, 6>() = information.topLeftCorner<6, 6>();
    prior_.topRightCorner<6, kLensNumbers>() = information.topRightCorner<6, kLensNumbers>();
    prior_.bottomLeftCorner<kLensNumbers, 6>() = information.bottomLeftCorner<kLensNumbers, 6>();
    prior_.bottomRightCorner<kLensNumbers, kLensNumbers>() =
        information.bottomRightCorner<kLensNumbers, kLensNumbers>();
    prior_.diagonal().segment<kSceneEdgeKinds>(kShiftAt).setConstant(
        1 / std::pow(options.shift_sigma_rad, 2));
    prior_(kBeamAt, kBeamAt) = 1 / std::pow(options.beam_sigma_rad, 2);
    prior_(kFartherAt, kFartherAt) = 1 / std::pow(options.farther_sigma_m, 2);
  }

  const SceneProblem& problem() const { return problem_; }
  const SceneMatrix& prior() const { return prior_; }
  const SceneState& start() const { return start_; }

  SceneVector OffPrior(const SceneState& state) const {
    SceneVector off;
    off.head<6>() = Log(state.camera_from_lidar * start_.camera_from_lidar.Inverse());
    for (std::size_t k = 0; k < state.shift_rad.size(); ++k) {
      off[kShiftAt + static_cast<Eigen::Index>(k)] = state.shift_rad[k];
    }
    off[kBeamAt] = state.beam_rad - start_.beam_rad;
    off[kFartherAt] = state.farther_m - start_.farther_m;
    off.tail<kLensNumbers>() = NumbersOf(state.lens) - NumbersOf(start_.lens);
    return off;
  }

  // Rounds of a look that narrows, until steps are small.
  SceneState Rounds(SceneState state, SceneLook* look, int most, bool learn) const {
    for (int i = 0; i < most; ++i) {
      const SceneSums sums = problem_.SumsAt(state, *look);
      const ShownEdges all = sums.All();
      if (!(all.matched > 0)) return state;
      const SceneMatrix h = sums.information + prior_;
      const SceneVector g = sums.gradient - prior_ * OffPrior(state);
      const SceneVector step = SolveSymmetric(h, g);
      if (!step.allFinite()) return state;
      state = state.Moved(step);
      for (std::size_t source = 0; source < kEdgeSources; ++source) {
        look->matched[source] = std::clamp(sums.shown[source].Share(), 0.05, 0.95);
      }
      if (learn) {
        look->sigma_px = std::clamp(std::sqrt(std::max(0.0, sums.squares / all.matched)),
                                    kLeastEdgePx, kMostEdgePx);
      }
      if (step.dot(h * step) < 1e-4) break;
    }
    return state;
  }

 private:
  const SceneProblem& problem_;
  SceneState start_;
  SceneMatrix prior_;
};

// How far the start may be off in the image [px].
double StartSigmaPx(const CameraSpec& camera, const NaturalOptions& options) {
  constexpr double kUsualRangeM = 5;
  const Vector6d variance = options.StartCovariance().diagonal();
  return camera.lens.fx * std::sqrt(variance.head<3>().maxCoeff() +
                                    variance.tail<3>().maxCoeff() / std::pow(kUsualRangeM, 2));
}

int LevelsFor(double off_px) {
  const double steps = std::log2(std::max(1.0, off_px / kCoarsestSigmaPx));
  return std::clamp(1 + static_cast<int>(std::ceil(steps)), 1, 7);
}

// Every how manieth edge gives so many in all.
std::size_t StrideFor(const SceneProblem& problem, std::size_t edges) {
  return std::max<std::size_t>(1, problem.edges() / edges);
}

// In the whole image, the look narrowing; `look`: the last one, with what the data say of edges.
SceneState AtFullResolution(const Solver& solver, SceneState state, SceneLook* look) {
  for (const double sigma_px : {3.0, 1.8, 1.0}) {
    look->level = 0;
    look->sigma_px = sigma_px;
    look->reach_px = static_cast<int>(std::ceil(3 * sigma_px)) + 2;
    state = solver.Rounds(state, look, 4, false);
  }
  look->reach_px = kFineReachPx;
  const SceneState found = solver.Rounds(state, look, 20, true);
  const SceneSums sums = solver.problem().SumsAt(found, *look);
  if (sums.shown[1].edges == 0 || sums.shown[1].Share() >= kLeastShown) return found;
  look->reflectivity = false;  // the camera sees other paint than the LIDAR does
  return solver.Rounds(found, look, 20, true);
}

double Fitness(const SceneSums& sums) {
  const double edges = sums.All().edges;
  return edges > 0 ? sums.log_likelihood / edges : 0;
}

struct Candidate {
  SceneState state;
  double fitness = 0;
};

void SortByFitness(std::vector<Candidate>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
}

// The start turned by rotation vectors on a grid, those that fit best in coarse pictures first.
std::vector<Candidate> TurnedStarts(const SceneProblem& problem, const SceneState& start,
                                    double most_rad, double step_rad) {
  const double off_px = 0.6 * step_rad * problem.spec().lens.fx;
  SceneLook look;
  look.stride = StrideFor(problem, 2000);
  look.level = std::min(problem.levels(), LevelsFor(off_px)) - 1;
  look.sigma_px = std::max(2.0, off_px / std::ldexp(1.0, look.level));
  look.reach_px = static_cast<int>(std::ceil(2 * look.sigma_px)) + 1;
  std::vector<Candidate> starts;
  // Farther than this nobody looks: it would take for ever.
  const int most = std::min(7, static_cast<int>(std::ceil(most_rad / step_rad)));
  for (int x = -most; x <= most; ++x) {
    for (int y = -most; y <= most; ++y) {
      for (int z = -most; z <= most; ++z) {
        Vector6d delta = Vector6d::Zero();
        delta.head<3>() = step_rad * Eigen::Vector3d(x, y, z);
        if (delta.norm() > most_rad + 0.5 * step_rad) continue;
        SceneState state = start;
        state.camera_from_lidar = Exp(delta) * start.camera_from_lidar;
        starts.push_back({state, Fitness(problem.SumsAt(state, look))});
      }
    }
  }
  SortByFitness(&starts);
  return starts;
}

bool AreApart(const SceneState& a, const SceneState& b, double rotation_rad, double centre_m) {
  return RotationDistance(a.camera_from_lidar, b.camera_from_lidar) > rotation_rad ||
         CentreDistance(a.camera_from_lidar, b.camera_from_lidar) > centre_m;
}

// The best ones that lie apart from each other, `most` at most.
std::vector<Candidate> BestApart(std::vector<Candidate> candidates, std::size_t most,
                                 double rotation_rad) {
  constexpr double kUsualRangeM = 3;
  SortByFitness(&candidates);
  std::vector<Candidate> kept;
  for (const Candidate& one : candidates) {
    if (kept.size() == most) break;
    const bool is_new = std::all_of(kept.begin(), kept.end(), [&](const Candidate& better) {
      return AreApart(one.state, better.state, rotation_rad, kUsualRangeM * rotation_rad);
    });
    if (is_new) kept.push_back(one);
  }
  return kept;
}

// The same, and moved to either side along each direction of the pose by what moves the edges about
// so many pixels of the level (RMS): far along directions that the scene hardly tells.
std::vector<SceneState> WithNeighbours(const SceneState& state, const SceneSums& sums,
                                       const SceneLook& look, const Vector6d& start_sigma) {
  std::vector<SceneState> out{state};
  const double matched = sums.All().matched;
  if (!(matched > 0)) return out;
  const Matrix6d information =
      start_sigma.asDiagonal() * sums.information.topLeftCorner<6, 6>() * start_sigma.asDiagonal();
  const auto system = EigensystemOf(Matrix6d(information + Matrix6d::Identity()));
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double per_pixel = std::sqrt(matched / system.values[k]) / look.sigma_px;
    for (const double pixels : {-2.0, -1.0, 1.0, 2.0}) {
      const double size = std::clamp(pixels * per_pixel, -1.5, 1.5);
      const Vector6d delta = start_sigma.cwiseProduct(size * system.vectors.col(k));
      SceneState moved = state;
      moved.camera_from_lidar = Exp(delta) * state.camera_from_lidar;
      out.push_back(moved);
    }
  }
  return out;
}

// Brought down from coarse pictures to middling ones by some of the edges, several at a time: where
// pictures are coarse the wrong one may fit as well as the right one. The best first.
std::vector<Candidate> Narrowed(const SceneProblem& problem, const Solver& solver,
                                std::vector<Candidate> states, int first,
                                const Vector6d& start_sigma) {
  const int last = std::min(1, first);
  for (int level = first; level >= last; --level) {
    SceneLook look;
    look.stride = StrideFor(problem, 3000);
    look.level = level;
    look.sigma_px = 1.5;
    look.reach_px = 7;
    std::vector<Candidate> wider;
    for (const Candidate& candidate : states) {
      const SceneSums sums = problem.SumsAt(candidate.state, look);
      for (const SceneState& state : WithNeighbours(candidate.state, sums, look, start_sigma)) {
        wider.push_back({state, Fitness(problem.SumsAt(state, look))});
      }
    }
    const double pixel_rad = std::ldexp(1.0, level) / problem.spec().lens.fx;
    wider = BestApart(std::move(wider), kTried, 0.7 * pixel_rad);
    for (Candidate& candidate : wider) {
      SceneLook solving = look;
      candidate.state = solver.Rounds(candidate.state, &solving, 6, false);
      candidate.fitness = Fitness(problem.SumsAt(candidate.state, look));
    }
    states = BestApart(std::move(wider), kKept, 0.7 * pixel_rad);
  }
  return states;
}

// The observed information, in no direction less than a tenth of the expected one: where edges are
// ambiguous throughout it may be negative, which is no information.
SceneMatrix ToldOf(const SceneMatrix& expected, const SceneMatrix& observed) {
  const auto system = EigensystemOf(expected);
  const SceneVector root = system.values.cwiseMax(1e-12).cwiseSqrt();
  const SceneMatrix whiten = system.vectors * root.cwiseInverse().asDiagonal();
  const auto share = EigensystemOf(SceneMatrix(whiten.transpose() * observed * whiten));
  const SceneMatrix back = system.vectors * root.asDiagonal() * share.vectors;
  return back * share.values.cwiseMax(0.1).cwiseMin(1).asDiagonal() * back.transpose();
}

// Each thing left out (jackknife, by a Newton step); and by how much things' own gradients are
// larger than stated: of one whose residuals are as stated, g' (H_g + R)^-1 g is on average
// tr (H_g + R)^-1 H_g, whatever R.
SceneMatrix CovarianceOf(const SceneSums& sums, const SceneMatrix& information,
                         const SceneMatrix& told, double* factor) {
  SceneMatrix jackknife = SceneMatrix::Zero();
  double squares = 0;
  double expected = 0;
  const auto count = static_cast<double>(sums.parts.size());
  for (const auto& [own, gradient] : sums.parts) {
    const SceneVector moved = SolveSymmetric(SceneMatrix(information - own), gradient);
    jackknife += moved * moved.transpose();
    const SceneMatrix with = own + information / count;
    squares += gradient.dot(SolveSymmetric(with, gradient));
    expected += SolveSymmetric(with, own).trace();
  }
  *factor = expected > 0 ? std::max(1.0, squares / expected) : 1;
  return jackknife + *factor * InverseOfSymmetric(told);
}

std::vector<SceneAlignment::Direction> DirectionsOf(const Matrix6d& covariance,
                                                    const Matrix6d& start_covariance) {
  const Vector6d sigma = start_covariance.diagonal().cwiseSqrt();
  const Matrix6d scaled =
      sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  const auto system = EigensystemOf(scaled);
  std::vector<SceneAlignment::Direction> directions;
  for (Eigen::Index k = 5; k >= 0; --k) {
    directions.push_back(
        {sigma.cwiseProduct(system.vectors.col(k)), std::sqrt(std::max(0.0, system.values[k]))});
  }
  return directions;
}

// Why the result is not to be used; empty: it is.
std::string WhyNot(const SceneAlignment& found, const Rigid3& start,
                   const NaturalOptions& options) {
  constexpr double kFewestThings = 2, kFewestEdges = 30, kMostSigmas = 6;
  const ShownEdges& depth = found.sums.Depth();
  if (depth.matched < kFewestEdges || found.sums.things < kFewestThings) {
    return "the images show too few of the cloud's depth edges (" +
           std::to_string(static_cast<int>(depth.matched)) +
           "): point the camera at things that stand free, 3 to 10 m away, and take more sweeps";
  }
  if (depth.Share() < kLeastShown) {
    return "the images show only " + std::to_string(static_cast<int>(100 * depth.Share())) +
           "% of the cloud's depth edges: the start is too far off (--search looks farther), the "
           "lens is wrong, or images and clouds are not of the same moment";
  }
  const Vector6d off = Log(found.state.camera_from_lidar * start.Inverse());
  const double sigmas = std::sqrt(off.dot(SolveSymmetric(options.StartCovariance(), off)));
  if (sigmas > kMostSigmas) {
    return "it ended " + std::to_string(static_cast<int>(sigmas)) +
           " sigma of the start away from it: the start is worse than stated (--search looks "
           "farther), or the solve is lost";
  }
  return "";
}

// Whether another pose, elsewhere, fits about as well as the best; empty: none does.
std::string WhyAmbiguous(const std::vector<Candidate>& sorted) {
  constexpr double kApartRad = 0.01, kApartM = 0.06;  // nearer ones are the same
  constexpr double kClearly = 0.03;                   // log-likelihood of an edge: less is chance
  for (const Candidate& other : sorted) {
    if (other.fitness < sorted[0].fitness - kClearly) break;
    if (!AreApart(other.state, sorted[0].state, kApartRad, kApartM)) continue;
    const PoseError apart =
        ErrorOf(other.state.camera_from_lidar, sorted[0].state.camera_from_lidar);
    char words[80];
    std::snprintf(words, sizeof(words), "two poses, %.1f deg and %.0f mm apart", apart.rotation_deg,
                  apart.translation_mm);
    return std::string(words) + ", fit about as well: take more sweeps, in other places";
  }
  return "";
}

// The result there; `ambiguous`: why it may be another one, or empty.
SceneAlignment AlignmentAt(const Solver& solver, const SceneState& state, const SceneLook& look,
                           const NaturalOptions& options, const std::string& ambiguous) {
  SceneAlignment out;
  out.state = state;
  out.look = look;
  out.sums = solver.problem().SumsAt(state, look);
  SceneLook observed = look;
  observed.observed = true;
  const SceneMatrix expected = out.sums.information + solver.prior();
  const SceneMatrix told =
      ToldOf(expected, solver.problem().SumsAt(state, observed).information + solver.prior());
  out.covariance = CovarianceOf(out.sums, expected, told, &out.scatter_factor);
  out.fit.camera_from_lidar = state.camera_from_lidar;
  out.fit.covariance = Matrix6d(out.covariance.topLeftCorner<6, 6>());
  out.directions = DirectionsOf(*out.fit.covariance, options.StartCovariance());
  out.fit.why_not = WhyNot(out, solver.start().camera_from_lidar, options);
  if (out.fit.why_not.empty()) out.fit.why_not = ambiguous;
  out.fit.converged = out.fit.why_not.empty();
  return out;
}

}  // namespace

Matrix6d NaturalOptions::StartCovariance() const {
  if (start_covariance) return Matrix6d(start_covariance->topLeftCorner<6, 6>());
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(rotation_sigma_rad),
      Eigen::Vector3d::Constant(translation_sigma_m);
  return Matrix6d(sigma.cwiseAbs2().asDiagonal());
}

SceneProblem MakeSceneProblem(const CameraSpec& camera, const std::vector<Shot>& shots,
                              const NaturalOptions& options) {
  return {camera, shots, options.edges, LevelsFor(StartSigmaPx(camera, options))};
}

SceneAlignment AlignToScene(const SceneProblem& problem, const Rigid3& start,
                            const NaturalOptions& options) {
  const double off_px = StartSigmaPx(problem.spec(), options);
  const Solver solver(problem, start, options);
  const Vector6d start_sigma = options.StartCovariance().diagonal().cwiseSqrt();
  const double turned = start_sigma.head<3>().maxCoeff();
  std::vector<Candidate> starts{{solver.start(), 0}};
  int first = 0;
  if (off_px > kCoarsestSigmaPx) {
    const double step = std::clamp(turned, kLeastStepRad, kMostStepRad);
    first = std::min(problem.levels(), LevelsFor(step * problem.spec().lens.fx)) - 1;
    const std::vector<Candidate> turns = TurnedStarts(problem, solver.start(), 2 * turned, step);
    starts.insert(starts.end(), turns.begin(),
                  turns.begin() + static_cast<std::ptrdiff_t>(std::min(kTried, turns.size())));
  }
  starts = Narrowed(problem, solver, std::move(starts), first, start_sigma);
  SceneLook look;
  const SceneState state = AtFullResolution(solver, starts[0].state, &look);
  return AlignmentAt(solver, state, look, options, WhyAmbiguous(starts));
}

SceneAlignment AlignNear(const SceneProblem& problem, const Rigid3& start,
                         const NaturalOptions& options, const std::vector<Rigid3>& near) {
  const Solver solver(problem, start, options);
  SceneState best;
  SceneLook best_look;
  double best_fitness = -std::numeric_limits<double>::infinity();
  for (const Rigid3& pose : near) {
    SceneState state = solver.start();
    state.camera_from_lidar = pose;
    SceneLook look;
    for (int level = std::min(3, problem.levels()) - 1; level > 0; --level) {
      look.level = level;
      look.sigma_px = 1.5;
      look.reach_px = 7;
      state = solver.Rounds(state, &look, 3, false);
    }
    state = AtFullResolution(solver, state, &look);
    const double fitness = Fitness(problem.SumsAt(state, look));
    if (fitness <= best_fitness) continue;
    best = state;
    best_look = look;
    best_fitness = fitness;
  }
  return AlignmentAt(solver, best, best_look, options, "");
}

double SceneFitness(const SceneProblem& problem, const SceneAlignment& alignment,
                    const Rigid3& camera_from_lidar) {
  SceneState state = alignment.state;
  state.camera_from_lidar = camera_from_lidar;
  return Fitness(problem.SumsAt(state, alignment.look));
}

}  // namespace rgbdt
