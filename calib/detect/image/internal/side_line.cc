#include "calib/detect/image/internal/side_line.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kVotePx = 0.75;    // how far from a line an edge supports it
constexpr double kGatePx = 1.5;     // an edge farther away is another edge
constexpr double kJitterPx = 0.05;  // of one edge, however strong: sampling, texture
// Sigma of an edge's place is this over its strength: the noise of the slope's derivative over the
// slope's curvature, for an edge blurred by 1.3 px in all.
constexpr double kPlacePx = 2.5;
// Smoothed by a Gaussian of 0.8 px, so many pixels along the edge share their noise.
constexpr double kSharedPx = 2.8;

struct Sample {
  double along = 0;     // [px]
  double offset = 0;    // [px]
  double sigma = 0;     // [px]
  double residual = 0;  // [px]
  double weight = 0;    // 0: not on the line
  double slope = 0;     // of weight * residual by the residual: how much the edge holds the line
  bool dark = false, bright = false;
  Eigen::Vector2d base;  // offset = base . (first, last)
};

Eigen::Vector2d BaseAt(double along, double length) {
  const double t = along / length;
  return {1 - t, t};
}

double Support(const std::vector<Profile>& profiles, double length, const Eigen::Vector2d& line) {
  double support = 0;
  for (const Profile& profile : profiles) {
    const double expected = BaseAt(profile.along_px, length).dot(line);
    double best = 0;
    for (const ProfileEdge& edge : profile.edges) {
      const double off = (edge.offset_px - expected) / kVotePx;
      if (off * off < 1) best = std::max(best, std::min(1.0, edge.strength / 12) * (1 - off * off));
    }
    support += best;
  }
  return support;
}

Eigen::Vector2d MostSupported(const std::vector<Profile>& profiles, double length, double inner,
                              double outer) {
  constexpr double kVoteStep = 0.25;
  const int steps = static_cast<int>((outer - inner) / kVoteStep) + 1;
  Eigen::Vector2d best(0, 0);
  double most = Support(profiles, length, best);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const Eigen::Vector2d line(inner + i * kVoteStep, inner + j * kVoteStep);
      const double support = Support(profiles, length, line);
      if (support > most) {
        most = support;
        best = line;
      }
    }
  }
  return best;
}

// Of each profile the edge nearest to the line, if near enough.
std::vector<Sample> Nearest(const std::vector<Profile>& profiles, double length,
                            const Eigen::Vector2d& line) {
  std::vector<Sample> samples;
  for (const Profile& profile : profiles) {
    Sample sample;
    sample.along = profile.along_px;
    sample.base = BaseAt(profile.along_px, length);
    sample.residual = kGatePx;
    bool found = false;
    for (const ProfileEdge& edge : profile.edges) {
      const double residual = edge.offset_px - sample.base.dot(line);
      if (std::abs(residual) >= std::abs(sample.residual)) continue;
      sample.offset = edge.offset_px;
      sample.residual = residual;
      sample.sigma = std::hypot(kPlacePx / edge.strength, kJitterPx);
      sample.dark = edge.dark;
      sample.bright = edge.bright;
      found = true;
    }
    if (found) samples.push_back(sample);
  }
  return samples;
}

// Of residuals over their sigmas, by the median.
double ScaleOf(const std::vector<Sample>& samples) {
  std::vector<double> ratios;
  ratios.reserve(samples.size());
  for (const Sample& s : samples) ratios.push_back(std::abs(s.residual) / s.sigma);
  return std::clamp(Median(std::move(ratios)) / 0.6745, 0.3, 3.0);
}

// Tukey's biweight: an edge 4.685 scales away counts nothing.
void Weigh(std::vector<Sample>* samples) {
  const double scale = ScaleOf(*samples);
  for (Sample& s : *samples) {
    const double off = s.residual / (4.685 * scale * s.sigma);
    const double keep = off * off < 1 ? 1 - off * off : 0;
    s.weight = keep * keep / (s.sigma * s.sigma);
    s.slope = keep * (1 - 5 * off * off) / (s.sigma * s.sigma);
  }
}

Eigen::Matrix2d Information(const std::vector<Sample>& samples) {
  Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
  for (const Sample& s : samples) h += s.weight * s.base * s.base.transpose();
  return h;
}

Eigen::Vector2d Solve(const std::vector<Sample>& samples) {
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  for (const Sample& s : samples) r += s.weight * s.offset * s.base;
  const Eigen::Matrix2d h = Information(samples) + 1e-9 * Eigen::Matrix2d::Identity();
  return SolveSymmetric(h, r);
}

// H^-1 M H^-1 with H of the robust loss's second derivatives and M the sum of products of
// neighbours' scores, weighted down to nothing at `correlation`.
Eigen::Matrix2d Sandwich(const std::vector<Sample>& samples, double correlation) {
  Eigen::Matrix2d m = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector2d score = samples[i].weight * samples[i].residual * samples[i].base;
    m += score * score.transpose();
    for (std::size_t k = i + 1; k < samples.size(); ++k) {
      const double apart = (samples[k].along - samples[i].along) / correlation;
      if (apart >= 1) break;
      const Eigen::Vector2d other = samples[k].weight * samples[k].residual * samples[k].base;
      m += (1 - apart) * (score * other.transpose() + other * score.transpose());
    }
  }
  Eigen::Matrix2d h = 1e-9 * Eigen::Matrix2d::Identity();
  for (const Sample& s : samples) h += s.slope * s.base * s.base.transpose();
  const Eigen::Matrix2d inverse = h.inverse();
  return inverse * m * inverse;
}

// By the residuals or by what the edges' strengths promise, whichever is more.
Eigen::Matrix2d CovarianceOf(const std::vector<Sample>& samples, double length,
                             double correlation) {
  const double independent = std::max(4.0, length / correlation);
  const Eigen::Matrix2d seen =
      independent / (independent - 2) * Sandwich(samples, correlation);  // two unknowns
  const Eigen::Matrix2d promised =
      kSharedPx * (Information(samples) + 1e-9 * Eigen::Matrix2d::Identity()).inverse();
  return seen.trace() > promised.trace() ? seen : promised;
}

void CountInside(const std::vector<Profile>& profiles, const std::vector<Sample>& samples,
                 SideLine* line) {
  int inside = 0;
  int with_edge = 0;
  for (const Profile& profile : profiles) {
    inside += profile.inside ? 1 : 0;
    with_edge += profile.edges.empty() ? 0 : 1;
  }
  double squares = 0;
  for (const Sample& s : samples) {
    if (s.weight == 0) continue;
    ++line->count;
    line->dark_share += s.dark ? 1 : 0;
    line->bright_share += s.bright ? 1 : 0;
    squares += s.residual * s.residual;
  }
  if (inside == 0 || line->count == 0) return;
  line->dark_share /= line->count;
  line->bright_share /= line->count;
  line->share = static_cast<double>(line->count) / inside;
  line->edge_share = static_cast<double>(with_edge) / inside;
  line->rms_px = std::sqrt(squares / line->count);
}

}  // namespace

SideLine FitSideLine(const std::vector<Profile>& profiles, double length_px, double inner_px,
                     double outer_px, double correlation_px) {
  SideLine line;
  Eigen::Vector2d ends = MostSupported(profiles, length_px, inner_px, outer_px);
  std::vector<Sample> samples;
  for (int i = 0; i < 15; ++i) {
    samples = Nearest(profiles, length_px, ends);
    if (samples.size() < 3) break;
    Weigh(&samples);
    ends = Solve(samples);
  }
  CountInside(profiles, samples, &line);
  if (line.count < 3) return line;
  for (Sample& s : samples) s.residual = s.offset - s.base.dot(ends);
  line.first_px = ends.x();
  line.last_px = ends.y();
  line.covariance = CovarianceOf(samples, length_px, correlation_px);
  // Where edges off the line abound, some of those on it are there by chance.
  const double chance = std::max(1.0, line.edge_share / line.share);
  line.covariance *= chance * chance;
  return line;
}

}  // namespace rgbdt
