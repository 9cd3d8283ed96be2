#include "calib/solve/internal/nuisances.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"

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

// Of the unknown at this place, a factor of variance counted in.
double SigmaAt(const JointResult& result, Eigen::Index at, double factor) {
  return std::sqrt(std::max(0.0, factor * result.solution.covariance(at, at)));
}

// The outline's and the pattern's, which somebody measured.
bool IsOfGivenSize(SharedUnknown unknown) {
  return (unknown >= kOutlineTop && unknown <= kOutlineLeft) || unknown == kPrintWidth ||
         unknown == kPrintHeight;
}

bool IsOfShape(SharedUnknown unknown) {
  return unknown == kBowX || unknown == kTwist || unknown == kBowY;
}

// An unknown that all views share.
Estimate EstimateOf(const JointResult& result, SharedUnknown unknown) {
  return {result.solution.state.shared[static_cast<std::size_t>(unknown)],
          SigmaAt(result, SharedPlaces(result.joint.problem).Of(unknown), result.variance_factor)};
}

// How much single sides differ, which no class explains: the solve's own estimate, from so many
// sides.
std::optional<Nuisance> SideScatter(const BoardProblem& problem) {
  double sides = 0;
  for (const BoardView& view : problem.views) {
    if (view.cloud.crossings.empty()) continue;
    sides += static_cast<double>(std::count(view.sides.begin(), view.sides.end(), true));
  }
  if (sides == 0) return std::nullopt;
  const double sigma = problem.priors.side_sigma_rad;
  return Nuisance{"beam edge, scatter of single sides",
                  "mrad",
                  {1000 * sigma, 1000 * sigma / std::sqrt(2 * sides)}};
}

// How much rings differ within a view, beyond their points' noise.
std::optional<Nuisance> ScatterOfRings(const BoardProblem& problem) {
  const double sigma = problem.priors.ring_view_sigma_m;
  double rings = 0;
  for (const BoardView& view : problem.views) {
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

// Nothing where the prior's sigma is left: the data say nothing of it then.
std::optional<Nuisance> LineOf(const NuisanceLine& line, const Estimate& estimate,
                               const BoardPriors& priors) {
  if (estimate.sigma > 0.98 * priors.Sigma(line.unknown)) return std::nullopt;
  return Nuisance{line.name, line.unit, {1000 * estimate.value, 1000 * estimate.sigma}};
}

void Append(std::optional<Nuisance> line, std::vector<Nuisance>* nuisances) {
  if (line) nuisances->push_back(std::move(*line));
}

// An offset of one of the problem's terms.
Estimate TermOf(const JointResult& result, std::size_t term) {
  const Eigen::Index at = SharedPlaces(result.joint.problem).RangeTerm(term);
  return {result.solution.state.range_terms[term], SigmaAt(result, at, result.variance_factor)};
}

Cause BeyondPrior(const NuisanceLine& line, const JointResult& result) {
  const BoardPriors& priors = result.joint.problem.priors;
  const Estimate estimate = EstimateOf(result, line.unknown);
  const double mean = priors.Means()[static_cast<std::size_t>(line.unknown)];
  const double prior = priors.Sigma(line.unknown);
  // Rather too little: what a model has wrong goes where the data tell least.
  const double variance = prior * prior + estimate.sigma * estimate.sigma;
  const double off = estimate.value - mean;
  const bool shape = IsOfShape(line.unknown);
  return {
      shape ? "board's shape" : "beams or board",
      Format("%s: %.1f +- %.1f %s, where %.1f +- %.1f %s is usual. Check that the board is flat%s",
             line.name, 1000 * estimate.value, 1000 * estimate.sigma, line.unit, 1000 * mean,
             1000 * prior, line.unit,
             shape ? ""
                   : " and as large as the rig file says, and the LIDAR's beam against its "
                     "data sheet"),
      off * off / variance};
}

// How far a camera's pose moves, in its own sigmas, where nothing is taken to be known beforehand
// of an unknown: one step of Newton without its prior, C / (1 - C_uu / prior^2) the covariance.
std::optional<double> MovesWithoutPrior(SharedUnknown unknown, const JointResult& result,
                                        std::size_t camera) {
  const BoardPriors& priors = result.joint.problem.priors;
  const Eigen::MatrixXd& covariance = result.solution.covariance;
  const Eigen::Index at = SharedPlaces(result.joint.problem).Of(unknown);
  const double weight = 1 / (priors.Sigma(unknown) * priors.Sigma(unknown));
  const double left = 1 - weight * covariance(at, at);
  if (!(left > 0)) return std::nullopt;
  const double off = result.solution.state.shared[static_cast<std::size_t>(unknown)] -
                     priors.Means()[static_cast<std::size_t>(unknown)];
  const Vector6d pose =
      covariance.col(at).segment<6>(SharedPlaces::Pose(camera)) * (weight * off / left);
  const Matrix6d of_pose = CovarianceOf(result, camera).topLeftCorner<6, 6>();
  return std::sqrt(std::max(0.0, pose.dot(SolveSymmetric(of_pose, pose))));
}

}  // namespace

std::vector<Nuisance> NuisancesOf(const JointResult& result, std::size_t camera) {
  const BoardProblem& problem = result.joint.problem;
  std::vector<Nuisance> nuisances;
  for (const NuisanceLine& line : kNuisances) {
    Append(LineOf(line, EstimateOf(result, line.unknown), problem.priors), &nuisances);
  }
  Append(SideScatter(problem), &nuisances);
  Append(ScatterOfRings(problem), &nuisances);
  for (Nuisance& line : LensLines(result, camera)) nuisances.push_back(std::move(line));
  return nuisances;
}

Estimate RangeOffsetOfLidar(const JointResult& result, std::size_t lidar) {
  return {result.solution.state.lidars[lidar].shared[kRangeOffset],
          SigmaAt(result, SharedPlaces(result.joint.problem).Of(lidar, kRangeOffset),
                  result.lidar_factors[lidar])};
}

std::vector<Nuisance> NuisancesOfLidar(const JointResult& result, std::size_t lidar) {
  const BoardProblem& of_lidar = result.joint.problem.lidars[lidar];
  const LidarState& state = result.solution.state.lidars[lidar];
  const SharedPlaces places(result.joint.problem);
  std::vector<Nuisance> nuisances;
  for (const NuisanceLine& line : kNuisances) {
    if (!IsOfLidar(line.unknown)) continue;
    const Estimate estimate{
        state.shared[static_cast<std::size_t>(line.unknown)],
        SigmaAt(result, places.Of(lidar, line.unknown), result.lidar_factors[lidar])};
    Append(LineOf(line, estimate, of_lidar.priors), &nuisances);
  }
  Append(SideScatter(of_lidar), &nuisances);
  Append(ScatterOfRings(of_lidar), &nuisances);
  return nuisances;
}

std::vector<Cause> BeyondPriors(const JointResult& result, std::size_t camera) {
  const BoardPriors& priors = result.joint.problem.priors;
  std::optional<Cause> of_beam, of_shape;
  for (const NuisanceLine& line : kNuisances) {
    if (IsOfGivenSize(line.unknown)) continue;
    if (!LineOf(line, EstimateOf(result, line.unknown), priors)) continue;
    const bool shape = IsOfShape(line.unknown);
    Cause cause = BeyondPrior(line, result);
    if (shape) cause.moves_sigma = MovesWithoutPrior(line.unknown, result, camera);
    std::optional<Cause>& farthest = shape ? of_shape : of_beam;
    if (!farthest || cause.chi2 > farthest->chi2) farthest = std::move(cause);
  }
  std::vector<Cause> causes;
  for (std::optional<Cause>* cause : {&of_beam, &of_shape}) {
    if (*cause) causes.push_back(std::move(**cause));
  }
  return causes;
}

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

}  // namespace rgbdt
