#include "calib/solve/internal/board_priors.h"

#include <array>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

constexpr double kExactLensSigma = 1e-6;  // [px], and of the distortion

// Of a lens's numbers; those that are exact are held to next to nothing.
LensCovariance InformationOfLens(LensCovariance prior) {
  for (Index i = 0; i < kLensNumbers; ++i) {
    if (!(prior(i, i) > 0)) prior(i, i) = kExactLensSigma * kExactLensSigma;
  }
  // In units of the sigmas: pixels and coefficients differ by orders of magnitude.
  const LensNumbers scale = prior.diagonal().cwiseSqrt().cwiseInverse();
  const LensCovariance correlation = scale.asDiagonal() * prior * scale.asDiagonal();
  return scale.asDiagonal() * InverseOfSymmetric(correlation) * scale.asDiagonal();
}

LensNumbers OffGivenLens(const BoardProblem& problem, const BoardState& state, std::size_t camera) {
  return NumbersOf(state.lenses[camera]) - NumbersOf(problem.cameras[camera].lens());
}

double InformationOfTerm(const BoardProblem& problem, std::size_t term) {
  const double sigma = problem.SigmaOfTerm(term);
  return 1 / (sigma * sigma);
}

// The terms of one kind, rings or octaves: [first, last).
struct Kind {
  std::size_t first = 0, last = 0;
};
std::array<Kind, 2> KindsOf(const RangeTerms& ranges) {
  return {Kind{0, ranges.rings.size()}, Kind{ranges.rings.size(), ranges.Count()}};
}

double MeanOf(const RangeTerms& ranges, const Kind& kind, const std::vector<double>& terms) {
  double mean = 0;
  for (std::size_t i = kind.first; i < kind.last; ++i) mean += ranges.shares[i] * terms[i];
  return mean;
}

// The cost with one LIDAR's range terms.
double WithTerms(const BoardProblem& of_lidar, const std::vector<double>& terms, double cost) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    cost += terms[i] * terms[i] * InformationOfTerm(of_lidar, i);
  }
  for (const Kind& kind : KindsOf(of_lidar.ranges)) {
    cost += std::pow(MeanOf(of_lidar.ranges, kind, terms) / kMeanTermSigmaM, 2);
  }
  return cost;
}

// One LIDAR's range terms, the first of them at `first`.
void AddTerms(const BoardProblem& of_lidar, const std::vector<double>& terms, Index first,
              ViewInformation* out) {
  const auto at = [&](std::size_t term) { return first + static_cast<Index>(term); };
  for (std::size_t i = 0; i < of_lidar.ranges.Count(); ++i) {
    out->information(at(i), at(i)) = InformationOfTerm(of_lidar, i);
    out->gradient[at(i)] = -terms[i] * out->information(at(i), at(i));
  }
  for (const Kind& kind : KindsOf(of_lidar.ranges)) {
    const double weight = 1 / (kMeanTermSigmaM * kMeanTermSigmaM);
    const double mean = MeanOf(of_lidar.ranges, kind, terms);
    for (std::size_t i = kind.first; i < kind.last; ++i) {
      const double by = weight * of_lidar.ranges.shares[i];
      for (std::size_t k = kind.first; k < kind.last; ++k) {
        out->information(at(i), at(k)) += by * of_lidar.ranges.shares[k];
      }
      out->gradient[at(i)] -= by * mean;
    }
  }
}

// The nuisances that a further LIDAR has of its own: place, how far off its mean, sigma.
struct OwnPrior {
  Index at = 0;
  double off = 0, sigma = 0;
};
std::vector<OwnPrior> OwnPriors(const BoardProblem& problem, const BoardState& state,
                                const SharedPlaces& places, std::size_t lidar) {
  const BoardPriors& priors = problem.lidars[lidar].priors;
  const auto means = priors.Means();
  std::vector<OwnPrior> own;
  for (int k = 0; k < kSharedUnknowns; ++k) {
    if (!IsOfLidar(k)) continue;
    const auto i = static_cast<std::size_t>(k);
    own.push_back({places.Of(lidar, k), state.lidars[lidar].shared[i] - means[i], priors.Sigma(k)});
  }
  return own;
}

}  // namespace

double PriorCost(const BoardProblem& problem, const BoardState& state) {
  const BoardPriors& priors = problem.priors;
  const auto means = priors.Means();
  double cost = 0;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    if (!problem.HasOwnLens(c)) continue;
    const LensNumbers off = OffGivenLens(problem, state, c);
    cost += off.dot(InformationOfLens(problem.lens_priors[c]) * off);
  }
  for (int k = 0; k < kSharedUnknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double off = state.shared[i] - means[i];
    cost += off * off / (priors.Sigma(k) * priors.Sigma(k));
  }
  cost = WithTerms(problem, state.range_terms, cost);
  if (problem.lidars.empty()) return cost;
  const SharedPlaces places(problem);
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    for (const OwnPrior& own : OwnPriors(problem, state, places, l)) {
      cost += own.off * own.off / (own.sigma * own.sigma);
    }
    cost = WithTerms(problem.lidars[l], state.lidars[l].range_terms, cost);
  }
  return cost;
}

ViewInformation PriorInformation(const BoardProblem& problem, const BoardState& state) {
  const SharedPlaces places(problem);
  const Index size = places.Count();
  const auto means = problem.priors.Means();
  ViewInformation out{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (int k = 0; k < kSharedUnknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double sigma = problem.priors.Sigma(k);
    out.information(places.Of(k), places.Of(k)) = 1 / (sigma * sigma);
    out.gradient[places.Of(k)] = -(state.shared[i] - means[i]) / (sigma * sigma);
  }
  AddTerms(problem, state.range_terms, places.RangeTerm(0), &out);
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    if (!problem.HasOwnLens(c)) continue;
    const Index at = places.Lens(c);
    const LensCovariance information = InformationOfLens(problem.lens_priors[c]);
    out.information.block<kLensNumbers, kLensNumbers>(at, at) = information;
    out.gradient.segment<kLensNumbers>(at) = -information * OffGivenLens(problem, state, c);
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    for (const OwnPrior& own : OwnPriors(problem, state, places, l)) {
      out.information(own.at, own.at) = 1 / (own.sigma * own.sigma);
      out.gradient[own.at] = -own.off / (own.sigma * own.sigma);
    }
    AddTerms(problem.lidars[l], state.lidars[l].range_terms, places.RangeTerm(l, 0), &out);
  }
  return out;
}

}  // namespace rgbdt
