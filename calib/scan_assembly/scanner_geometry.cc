#include "calib/scan_assembly/scanner_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/scan_assembly/internal/scan_patches.h"
#include "calib/scan_assembly/internal/scanner_directions.h"

namespace rgbdt {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// From coarse to fine: large tiles still hold both halves of a surface when the geometry is far
// off, though they are bent then; small ones see more of the room.
struct Stage {
  double bend_m;        // on top of the noise
  double max_turn_rad;  // between the halves' planes
  double max_gap_m;
  double gap_scale_m;  // Cauchy's, of a patch
  int first_level, last_level, iterations;
};

constexpr std::array<Stage, 3> kStages = {{{0.03, 12 * kDegree, 0.8, 0.2, 2, 4, 6},
                                           {0.01, 6 * kDegree, 0.15, 0.03, 3, 5, 5},
                                           {0, 4 * kDegree, 0.05, 0.01, 3, 6, 4}}};

class Solver {
 public:
  Solver(const TurnedScanner& guess, const std::vector<TurnedBeams>& sweeps,
         const ScannerGeometryOptions& options)
      : options_(options),
        guess_(guess.motor_from_scanner),
        estimate_(guess_),
        prior_(PriorOf(options)),
        beams_(sweeps, guess, options.max_beams) {
    const double noise = RangeNoise(beams_);
    sigma_m_ = noise > 0 ? std::max(noise, 1e-4) : options.range_sigma_m;
    for (int i = 0; i < 7; ++i) held_[static_cast<std::size_t>(i)] = IsGauge(i);
  }

  void Run();
  void Fill(ScannerGeometry* result);

 private:
  void RunStage(const Stage& stage);
  void Polish();
  bool HoldUnobserved();
  Matrix7d Covariance() const;
  void KeepConsistent();
  bool Step(const ScanEquations& equations);
  ScanEquations Equations() const;
  double NoiseScale() const;
  double MisfitScale() const;
  void FillSurfaces(ScannerGeometry* result);

  const ScannerGeometryOptions& options_;
  const Rigid3 guess_;
  Rigid3 estimate_;
  const Vector7d prior_;
  PlacedBeams beams_;
  double sigma_m_ = 0;
  PatchList found_;
  Vector7d last_sigmas_ = Vector7d::Zero();  // of the last step, in its own sigmas
  std::array<bool, 7> held_ = {};            // as guessed
  bool converged_ = false;
};

// What is held is taken out of the equations; gauges are: no sweep tells them, and rounding errors
// would make them wander.
bool Solver::Step(const ScanEquations& equations) {
  constexpr double kSmall = 1e-3;  // of a sigma
  Matrix7d information = equations.information;
  Vector7d off;
  off << Log(estimate_ * guess_.Inverse()), 0;
  Vector7d gradient = equations.gradient - Vector7d(off.array() / prior_.array().square());
  for (int i = 0; i < 7; ++i) {
    if (!held_[static_cast<std::size_t>(i)]) continue;
    information.row(i).setZero();
    information.col(i).setZero();
    gradient[i] = 0;
  }
  const Matrix7d covariance = CovarianceOf(information, prior_);
  Vector7d step = covariance * gradient;
  last_sigmas_ = step.cwiseAbs().cwiseQuotient(covariance.diagonal().cwiseSqrt());
  // No step leaves what the equations are linear in.
  const double large = (step.cwiseAbs().cwiseQuotient(prior_)).maxCoeff();
  if (large > 0.5) step *= 0.5 / large;
  estimate_ = Exp(step.head<6>()) * estimate_;
  beams_.Place(estimate_);
  return last_sigmas_.maxCoeff() < kSmall;
}

void Solver::RunStage(const Stage& stage) {
  PatchSearch search;
  search.sigma_m = std::hypot(sigma_m_, stage.bend_m);
  search.max_turn_rad = stage.max_turn_rad;
  search.max_gap_m = stage.max_gap_m;
  search.first_level = stage.first_level;
  search.last_level = stage.last_level;
  for (int i = 0; i < stage.iterations; ++i) {
    found_ = FindPatches(beams_, search);
    ScanEquations equations;
    for (const ScanPatch& patch : found_.patches) {
      const double gap = patch.gap_m / stage.gap_scale_m;
      equations.Add(beams_, patch.joint, search.sigma_m, 1 / (1 + gap * gap));
    }
    Step(equations);
  }
}

// Chi-square of the halves' planes over their degrees of freedom: whatever the geometry, noise.
double Solver::NoiseScale() const {
  double chi2 = 0, dof = 0;
  for (const ScanPatch& patch : found_.patches) {
    chi2 += patch.before.chi2 + patch.behind.chi2;
    dof += patch.before.dof() + patch.behind.dof();
  }
  return dof > 0 ? chi2 / dof : 1;
}

// The same of how well halves agree, beside the noise: more than 1 where ranges of one piece err
// alike. Of patches and unknowns so many that chance is a few percent.
double Solver::MisfitScale() const {
  double misfit = 0;
  for (const ScanPatch& patch : found_.patches) misfit += patch.Misfit();
  const double dof = 3 * static_cast<double>(found_.patches.size()) - 4;
  return dof > 0 ? std::max(1.0, misfit / dof / NoiseScale()) : 1;
}

// Leaves out patches whose halves differ beyond chance: something moved, or it is no plane.
void Solver::KeepConsistent() {
  constexpr double kMedian = 2.366, kMost = 16.27;  // of chi-square of 3: 50% and 99.9%
  std::vector<double> misfits;
  for (const ScanPatch& patch : found_.patches) misfits.push_back(patch.Misfit());
  if (misfits.empty()) return;
  const double most = kMost * std::max(NoiseScale(), Median(std::move(misfits)) / kMedian);
  auto& patches = found_.patches;
  patches.erase(std::remove_if(patches.begin(), patches.end(),
                               [&](const ScanPatch& patch) { return patch.Misfit() > most; }),
                patches.end());
}

ScanEquations Solver::Equations() const {
  ScanEquations equations;
  for (const ScanPatch& patch : found_.patches) {
    equations.Add(beams_, patch.joint, sigma_m_, 1);
  }
  return equations;
}

// The patches stay what they are from here on; no weights, so that the covariance is the errors'.
void Solver::Polish() {
  for (int i = 0; i < options_.max_iterations && !converged_; ++i) {
    if (i == 1) KeepConsistent();
    converged_ = Step(Equations()) && i > 1;
    for (ScanPatch& patch : found_.patches) RefitPatch(beams_, sigma_m_, &patch);
  }
}

// What the noise of normals feigns is taken off; what then is left of a direction that nothing
// tells may be negative.
Matrix7d Solver::Covariance() const {
  Matrix7d information = Equations().information;
  for (const ScanPatch& patch : found_.patches) {
    information -= FeignedInformation(beams_, patch.joint, sigma_m_);
  }
  const Matrix7d scaled = prior_.asDiagonal() * information * prior_.asDiagonal();
  const Eigensystem<7> axes = EigensystemOf(scaled);
  const Matrix7d observed =
      axes.vectors * axes.values.cwiseMax(0).asDiagonal() * axes.vectors.transpose();
  const Vector7d back = prior_.cwiseInverse();
  const Matrix7d kept = back.asDiagonal() * observed * back.asDiagonal();
  return CovarianceOf(kept / (NoiseScale() * MisfitScale()), prior_);
}

// Puts back to the guess what the sweep does not tell. True where there is such a thing.
bool Solver::HoldUnobserved() {
  const Vector7d sigmas = Covariance().diagonal().cwiseSqrt();
  Vector6d change = Log(estimate_ * guess_.Inverse());
  bool any = false;
  for (int i = 0; i < 6; ++i) {
    bool& held = held_[static_cast<std::size_t>(i)];
    if (held || sigmas[i] < options_.observed_below * prior_[i]) continue;
    held = any = true;
    change[i] = 0;
  }
  estimate_ = Exp(change) * guess_;
  beams_.Place(estimate_);
  return any;
}

void Solver::Run() {
  for (const Stage& stage : kStages) RunStage(stage);
  Polish();
  while (HoldUnobserved()) {  // at most once for each of the four
    RunStage(kStages.back());
    converged_ = false;
    Polish();
  }
}

double Rms(const std::vector<DoubleSurface>& surfaces, double DoubleSurface::*gap) {
  double sum = 0;
  for (const DoubleSurface& surface : surfaces) sum += surface.*gap * surface.*gap;
  return surfaces.empty() ? 0 : std::sqrt(sum / static_cast<double>(surfaces.size()));
}

void Solver::FillSurfaces(ScannerGeometry* result) {
  for (const ScanPatch& patch : found_.patches) {
    result->surfaces.push_back({beams_.sweep(patch.joint.beams[0]), patch.joint.centre,
                                patch.joint.normal, 0, patch.gap_m});
    result->beams += patch.joint.beams.size();
  }
  beams_.Place(guess_);
  for (std::size_t i = 0; i < found_.patches.size(); ++i) {
    RefitPatch(beams_, sigma_m_, &found_.patches[i]);
    result->surfaces[i].gap_before_m = found_.patches[i].gap_m;
  }
  beams_.Place(estimate_);
  result->gap_before_m = Rms(result->surfaces, &DoubleSurface::gap_before_m);
  result->gap_after_m = Rms(result->surfaces, &DoubleSurface::gap_after_m);
}

std::string WhyNot(const ScannerGeometry& result, bool converged,
                   const ScannerGeometryOptions& options) {
  const auto patches = static_cast<int>(result.surfaces.size());
  if (patches < options.min_patches) {
    return "not enough surfaces seen by both halves of the scan line: " + std::to_string(patches) +
           " pieces, " + std::to_string(options.min_patches) +
           " are needed. Sweep a room by 360 degrees with a scan line that reaches over the "
           "vertical";
  }
  const bool any = std::any_of(result.directions.begin(), result.directions.end(),
                               [](const ScannerDirection& d) { return d.observed; });
  if (!any) return "the surfaces seen by both halves of the scan line tell nothing of the geometry";
  return converged ? "" : "the last steps were no small ones: do not use it";
}

void Solver::Fill(ScannerGeometry* result) {
  result->range_sigma_m = sigma_m_ * std::sqrt(NoiseScale());
  result->seen_twice =
      found_.tiles > 0 ? static_cast<double>(found_.tiles_twice) / found_.tiles : 0;
  result->covariance = Covariance();
  Vector7d change;
  change << Log(estimate_ * guess_.Inverse()), 0;
  FillSurfaces(result);
  result->directions = DirectionsOf(result->covariance, change, options_, result->seen_twice);
  result->detail = WhyNot(*result, converged_, options_);
  result->converged = result->detail.empty();
  if (result->converged) result->scanner.motor_from_scanner = estimate_;
}

std::string Line(const ScannerDirection& direction, bool as_above) {
  const double unit = direction.is_angle ? kDegree : 1e-3;
  const char* name = direction.is_angle ? "deg" : "mm";
  if (direction.observed) {
    return Format("  %-15s %+9.4f %-3s +- %.4f\n", direction.name.c_str(), direction.change / unit,
                  name, direction.sigma / unit);
  }
  return Format("  %-15s not observed by this sweep, left as it was: ", direction.name.c_str()) +
         (as_above ? "as above" : direction.why) + "\n";
}

}  // namespace

void ScannerGeometryOptions::Check() const {
  const OptionCheck check("scanner geometry");
  check.Positive(range_sigma_m, "range_sigma_m");
  check.Positive(lever_prior_m, "lever_prior_m");
  check.Positive(tilt_prior_rad, "tilt_prior_rad");
  check.Positive(observed_below, "observed_below");
  check.AtLeast(min_patches, 1, "min_patches");
  check.Positive(static_cast<double>(max_beams), "max_beams");
  check.AtLeast(max_iterations, 3, "max_iterations");
}

std::string ScannerGeometry::BriefReport() const {
  std::string report = Format(
      "%s\n%zu pieces of surface seen by both halves of the scan line (%zu beams; %.0f%% "
      "of what was hit is seen twice), range noise %.1f mm\n"
      "distance between the halves, RMS: %.2f mm before, %.2f mm after\n"
      "change of motor_from_scanner (to its left: about and along the motor's axes), and "
      "sigma:\n",
      converged ? "converged" : ("NOT CONVERGED: " + detail).c_str(), surfaces.size(), beams,
      100 * seen_twice, 1000 * range_sigma_m, 1000 * gap_before_m, 1000 * gap_after_m);
  std::string why;
  for (const ScannerDirection& direction : directions) {
    report += Line(direction, direction.why == why);
    why = direction.why;
  }
  return report;
}

ScannerGeometry FindScannerGeometry(const TurnedScanner& guess,
                                    const std::vector<TurnedBeams>& sweeps,
                                    const ScannerGeometryOptions& options) {
  options.Check();
  const bool any = std::any_of(sweeps.begin(), sweeps.end(),
                               [](const TurnedBeams& beams) { return beams.size() > 0; });
  if (!any) throw InputError("scanner geometry: none of the sweeps has a beam that hit anything");
  Solver solver(guess, sweeps, options);
  solver.Run();
  ScannerGeometry result;
  result.scanner = guess;
  solver.Fill(&result);
  return result;
}

}  // namespace rgbdt
