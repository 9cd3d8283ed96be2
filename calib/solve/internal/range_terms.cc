#include "calib/solve/internal/range_terms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "calib/model/range_errors.h"
#include "calib/solve/internal/evidence.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

constexpr double kLeastSigmaM = 1e-4, kMostSigmaM = 0.03;  // beyond what any LIDAR is off
constexpr double kChanceGain = 13.8;  // one sigma more, at zero or above: once in 10,000
constexpr double kSettled = 0.05;     // of a sigma

bool Differs(double now, double before) { return std::abs(now - before) > kSettled * before; }

// All that the views' groups could have. By brightness only where a board has dark and bright: of a
// plain one brightness differs from view to view, as its distance does, and tells nothing by
// itself.
RangeTerms AllTerms(const BoardProblem& problem) {
  std::set<int> rings;
  double least = 0;
  double most = kLeastLog2Intensity;
  for (const BoardView& view : problem.views) {
    for (const PointGroup& group : view.cloud.groups) {
      if (group.ring >= 0) rings.insert(group.ring);
      least = std::min(least, group.log2_intensity);
      most = std::max(most, group.log2_intensity);
    }
  }
  RangeTerms terms;
  if (rings.size() > 1) terms.rings.assign(rings.begin(), rings.end());
  terms.first_octave = std::floor(least);
  const double octaves = std::ceil(most) - terms.first_octave + 1;
  if (octaves > 2 && problem.target.HasPattern()) terms.octaves = static_cast<std::size_t>(octaves);
  // The groups' points, shared out among their terms.
  terms.shares.assign(terms.Count(), 0);
  double points = 0;
  for (const BoardView& view : problem.views) {
    for (const PointGroup& group : view.cloud.groups) {
      const double of_group = group.scatter(3, 3);
      points += of_group;
      for (const auto& [term, weight] : terms.PartsOf(group)) {
        terms.shares[term] += weight * of_group;
      }
    }
  }
  for (double& share : terms.shares) share /= std::max(1.0, points);
  return terms;
}

// All of the terms, or those of one kind alone.
RangeTerms Opened(const RangeTerms& all, bool rings, bool octaves) {
  RangeTerms open = all;
  const auto middle = static_cast<std::ptrdiff_t>(all.rings.size());
  if (!octaves) {
    open.octaves = 0;
    open.shares.erase(open.shares.begin() + middle, open.shares.end());
  }
  if (!rings) {
    open.rings.clear();
    open.shares.erase(open.shares.begin(), open.shares.begin() + middle);
  }
  return open;
}

// The values of one set of terms, as far as another has them; zero else.
std::vector<double> ValuesOf(const RangeTerms& terms, const RangeTerms& had,
                             const std::vector<double>& values) {
  std::vector<double> out(terms.Count(), 0);
  for (std::size_t i = 0; i < terms.rings.size(); ++i) {
    const auto at = std::lower_bound(had.rings.begin(), had.rings.end(), terms.rings[i]);
    if (at != had.rings.end() && *at == terms.rings[i]) {
      out[i] = values[static_cast<std::size_t>(at - had.rings.begin())];
    }
  }
  if (had.octaves > 0) {
    for (std::size_t i = 0; i < terms.octaves; ++i) {
      const double octave = terms.first_octave + static_cast<double>(i) - had.first_octave;
      if (octave < 0 || octave >= static_cast<double>(had.octaves)) continue;
      out[terms.rings.size() + i] = values[had.rings.size() + static_cast<std::size_t>(octave)];
    }
  }
  return out;
}

std::vector<Index> Places(const SharedPlaces& places, std::size_t first, std::size_t count) {
  std::vector<Index> out(count);
  std::iota(out.begin(), out.end(), places.RangeTerm(first));
  return out;
}

// What each view's rings are off by, as the solution has it.
struct RingScatter {
  std::vector<RingOff> all;
  double freedom = 0;  // what the views' planes and open terms leave of it

  RingScatter(const BoardProblem& problem, const BoardSolution& solution) {
    for (std::size_t v = 0; v < problem.views.size(); ++v) {
      const RingsInView view = RingsOff(problem, solution.state, v);
      freedom += static_cast<double>(view.rings.size()) - view.fitted;
      all.insert(all.end(), view.rings.begin(), view.rings.end());
    }
    const SharedPlaces places(problem);
    for (std::size_t i = 0; i < problem.ranges.Count(); ++i) {
      const double sigma = problem.SigmaOfTerm(i);
      const Index at = places.RangeTerm(i);
      freedom -= std::max(0.0, 1 - solution.covariance(at, at) / (sigma * sigma));
    }
  }

  // Beyond the rings' own noise, all views alike.
  double InView() const {
    std::vector<double> offsets;
    std::vector<double> variances;
    for (const RingOff& ring : all) {
      offsets.push_back(ring.offset_m);
      variances.push_back(ring.variance_m2);
    }
    return ScatterBeyond(offsets, variances, freedom);
  }

  // Each ring's mean over the views taken off (`in_view`: what they scatter besides), and whether
  // these means differ by more than chance makes of the rest.
  struct WithoutMeans;
  WithoutMeans TakeMeansOff(double in_view) const;
};

struct RingScatter::WithoutMeans {
  RingScatter rest;
  bool means_differ = false;
};

RingScatter::WithoutMeans RingScatter::TakeMeansOff(double in_view) const {
  struct Sums {
    double weight = 0, offset = 0;
  };
  std::map<int, Sums> rings;
  const auto weight_of = [&](const RingOff& ring) {
    return 1 / (ring.variance_m2 + in_view * in_view);
  };
  for (const RingOff& ring : all) {
    rings[ring.ring].weight += weight_of(ring);
    rings[ring.ring].offset += weight_of(ring) * ring.offset_m;
  }
  WithoutMeans out{*this, false};
  double between = 0;
  double within = 0;
  for (RingOff& ring : out.rest.all) {
    const double mean = rings[ring.ring].offset / rings[ring.ring].weight;
    between += weight_of(ring) * mean * mean;
    ring.offset_m -= mean;
    within += weight_of(ring) * ring.offset_m * ring.offset_m;
  }
  const auto means = static_cast<double>(rings.size());
  out.rest.freedom -= means;
  // What all rings have in common is the common offset's.
  out.means_differ =
      Exceeds(between / (means - 1), means - 1, within / out.rest.freedom, out.rest.freedom);
  return out;
}

// The problem with all terms that there could be, and what the views say of them.
struct Wide {
  BoardProblem problem;
  BoardState state;
  ViewInformation all;
};

Wide WithAllTerms(const BoardProblem& problem, const BoardState& state) {
  Wide wide{problem, state, {}};
  wide.problem.ranges = AllTerms(problem);
  wide.state.range_terms = ValuesOf(wide.problem.ranges, problem.ranges, state.range_terms);
  // No prior of what is closed: its columns are left out.
  if (!(problem.priors.ring_sigma_m > 0)) wide.problem.priors.ring_sigma_m = INFINITY;
  if (!(problem.priors.octave_sigma_m > 0)) wide.problem.priors.octave_sigma_m = INFINITY;
  wide.all = PriorInformation(wide.problem, wide.state);
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const ViewInformation view = InformationOf(wide.problem, wide.state, v);
    wide.all.information += view.information;
    wide.all.gradient += view.gradient;
  }
  return wide;
}

// The sigma of terms [first, first + count), those of `other` being open, too; zero where they are
// not open now (`now`, their sigma) and become likelier by no more than `least_gain`.
double SigmaOf(const Wide& wide, std::size_t first, std::size_t count, double now,
               double least_gain, const std::vector<Index>& other) {
  if (count == 0) return 0;
  const SharedPlaces places(wide.problem);
  const std::vector<Index> kept = Places(places, first, count);
  std::vector<Index> others(static_cast<std::size_t>(places.RangeTerm(0)));
  std::iota(others.begin(), others.end(), Index{0});
  others.insert(others.end(), other.begin(), other.end());
  // What further LIDARs add.
  for (Index at = places.RangeTerm(wide.problem.ranges.Count()); at < places.Count(); ++at) {
    others.push_back(at);
  }
  ViewInformation said = Marginal(wide.all, kept, others);
  Eigen::VectorXd values(static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    values[static_cast<Index>(i)] = wide.state.range_terms[first + i];
  }
  if (now > 0) {  // the views alone, about zero
    said.information.diagonal().array() -= 1 / (now * now);
    said.gradient += values / (now * now);
  }
  said.gradient += said.information * values;
  // Their mean is known to be zero: it tells nothing of their sigma.
  const Eigen::VectorXd mean =
      Eigen::Map<const Eigen::VectorXd>(wide.problem.ranges.shares.data() + first,
                                        static_cast<Index>(count))
          .normalized();
  const Eigen::MatrixXd without =
      Eigen::MatrixXd::Identity(mean.size(), mean.size()) - mean * mean.transpose();
  const Evidence evidence = MostLikelySigma(without * said.information * without,
                                            without * said.gradient, kLeastSigmaM, kMostSigmaM);
  if (now > 0) return std::max(kLeastSigmaM, evidence.sigma);
  return evidence.gain > least_gain ? evidence.sigma : 0;
}

}  // namespace

bool FitRangeTerms(const BoardSolution& solution, BoardProblem* problem, BoardState* state) {
  BoardPriors& priors = problem->priors;
  bool changed = false;
  const RingScatter scatter(*problem, solution);
  double in_view = scatter.InView();
  bool rings_differ = priors.ring_sigma_m > 0;
  if (!rings_differ && !problem->ranges_exact) {
    const auto without = scatter.TakeMeansOff(in_view);
    rings_differ = without.means_differ;
    if (rings_differ) in_view = without.rest.InView();
  }
  if (Differs(in_view, priors.ring_view_sigma_m)) {
    priors.ring_view_sigma_m = in_view;
    changed = true;
  }
  if (problem->ranges_exact) return changed;
  const Wide wide = WithAllTerms(*problem, solution.state);
  const RangeTerms& all = wide.problem.ranges;
  const SharedPlaces places(wide.problem);
  const std::size_t rings = all.rings.size();
  const auto ring_places = Places(places, 0, rings);
  const auto octave_places = Places(places, rings, all.octaves);
  const std::vector<Index> none;
  const double ring = rings_differ ? SigmaOf(wide, 0, rings, priors.ring_sigma_m, 0,
                                             priors.octave_sigma_m > 0 ? octave_places : none)
                                   : 0;
  const double octave = SigmaOf(wide, rings, all.octaves, priors.octave_sigma_m, kChanceGain,
                                priors.ring_sigma_m > 0 ? ring_places : none);
  if (Differs(ring, priors.ring_sigma_m) || Differs(octave, priors.octave_sigma_m)) {
    const RangeTerms open = Opened(all, ring > 0, octave > 0);
    state->range_terms = ValuesOf(open, all, wide.state.range_terms);
    problem->ranges = open;
    priors.ring_sigma_m = ring;
    priors.octave_sigma_m = octave;
    changed = true;
  }
  return changed;
}

}  // namespace rgbdt
