#include "calib/detect/image/internal/corner_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/detect/image/internal/lower_bound.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr int kUnknowns = 16;
constexpr int kLinear = 11;         // the last ones: contrast and b
constexpr int kCubic = 4;           // the last ones of these: only where the rest does not do
constexpr double kMostPx = 10;      // edges are straight enough and blur is seen within that
constexpr double kMostShift = 0.3;  // of the distance to the next corner
constexpr int kRounds = 20;
constexpr double kLeastBlur = 0.4;  // [px]: a pixel's own area
// Of pixels that are saturated:
constexpr int kNoiseRounds = 3;       // of solving and telling the noise from what is left over
constexpr double kFirstNoise = 0.05;  // of the contrast
constexpr double kLeastNoise = 2e-3;  // likewise

// x y, two angles, blur, contrast, 1 x y, xx xy yy, xxx xxy xyy yyy
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct Pixel {
  double x, y, value;  ///< place against where the search began
};

struct Equations {
  Normal normal = Normal::Zero();
  Unknowns right = Unknowns::Zero();
  double squares = 0;      ///< what is made smallest: for values alone, their residuals' squares
  int values = 0;          ///< pixels that are no bounds
  double unexplained = 0;  ///< the residuals' squares, and what bounds add to these

  /// A pixel whose value is at least the level; `above`: the model's value, less that level.
  void AddBound(const Unknowns& j, double above, double noise) {
    const double z = above / noise;
    if (z > 8) return;  // 1e-15 of a pixel
    const LowerBound bound(z);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(j, bound.weight);
    right += noise * bound.residual * j;
    squares += 2 * noise * noise * bound.cost;
    unexplained -= noise * noise * z * bound.residual;
  }
};

// The edge's profile and its derivative by the distance.
struct Step {
  Step(double e, double s)
      : value(std::erf(e / (1.4142135623730951 * s))),
        slope(0.7978845608028654 / s * std::exp(-0.5 * e * e / (s * s))) {}
  double value, slope;
};

// What is not solved for.
struct Fixed {
  double level = kNeverSaturated;         ///< a value from here on is a lower bound
  double noise = 0;                       ///< of a value; matters to bounds only
  bool shape = false;                     ///< angles and blur stay as they are
  bool cubic = true;                      ///< and so do b's terms of third degree
  double curvature1 = 0, curvature2 = 0;  ///< of the edges, towards rising e1 and e2 [1/px]
  LonePatch lone{0, 0};
};

// How the patches differ, from -1 to 1 (of a lone one from 0 to 2), and its derivatives by the
// distances from the edges.
struct Patches {
  Patches(const Step& first, const Step& second, const LonePatch& lone) {
    if (lone.x() == 0) {
      value = first.value * second.value;
      by_first = first.slope * second.value;
      by_second = first.value * second.slope;
      return;
    }
    const double a = 1 + lone.x() * first.value;
    const double b = 1 + lone.y() * second.value;
    value = 0.5 * a * b;
    by_first = 0.5 * lone.x() * first.slope * b;
    by_second = 0.5 * a * lone.y() * second.slope;
  }
  double value, by_first, by_second;
};

Equations EquationsAt(const std::vector<Pixel>& pixels, const Unknowns& u, const Fixed& fixed) {
  Equations sums;
  const double c1 = std::cos(u[2]), s1 = std::sin(u[2]);
  const double c2 = std::cos(u[3]), s2 = std::sin(u[3]);
  for (const Pixel& p : pixels) {
    const double x = p.x - u[0];
    const double y = p.y - u[1];
    const double t1 = c1 * y - s1 * x;  // along the edges
    const double t2 = c2 * y - s2 * x;
    const double e1 = c1 * x + s1 * y - 0.5 * fixed.curvature1 * t1 * t1;
    const double e2 = c2 * x + s2 * y - 0.5 * fixed.curvature2 * t2 * t2;
    const Step first(e1, u[4]);
    const Step second(e2, u[4]);
    const Patches patches(first, second, fixed.lone);
    const double g1 = u[5] * patches.by_first;
    const double g2 = u[5] * patches.by_second;
    Unknowns j;
    j << -(g1 * c1 + g2 * c2), -(g1 * s1 + g2 * s2), g1 * t1, g2 * t2, -(g1 * e1 + g2 * e2) / u[4],
        patches.value, 1, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y, p.x * p.x * p.x,
        p.x * p.x * p.y, p.x * p.y * p.y, p.y * p.y * p.y;
    if (fixed.shape) j.segment<3>(2).setZero();
    if (fixed.cubic) j.tail<kCubic>().setZero();
    const double model = j.tail<kLinear>().dot(u.tail<kLinear>());
    if (p.value >= fixed.level) {
      sums.AddBound(j, model - fixed.level, fixed.noise);
      continue;
    }
    const double residual = p.value - model;
    if (fixed.cubic) {  // the rest is zero
      constexpr int kUsed = kUnknowns - kCubic;
      sums.normal.topLeftCorner<kUsed, kUsed>().selfadjointView<Eigen::Lower>().rankUpdate(
          j.head<kUsed>());
    } else {
      sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(j);
    }
    sums.right += residual * j;
    sums.squares += residual * residual;
    sums.unexplained += residual * residual;
    ++sums.values;
  }
  sums.normal = sums.normal.selfadjointView<Eigen::Lower>();
  if (fixed.shape) sums.normal.diagonal().segment<3>(2).setOnes();
  if (fixed.cubic) sums.normal.diagonal().tail<kCubic>().setOnes();
  return sums;
}

std::vector<Pixel> PixelsRound(const cv::Mat& grey, const Eigen::Vector2d& place,
                               const Eigen::Matrix2d& steps, double clear, const LonePatch& lone) {
  std::vector<Pixel> pixels;
  const Eigen::Matrix2d grid_from_image = steps.inverse();
  const Eigen::Vector2d reach = CornerReach(steps);
  const double rx = reach.x();
  const double ry = reach.y();
  if (place.x() < rx || place.y() < ry || place.x() > grey.cols - 1 - rx ||
      place.y() > grey.rows - 1 - ry) {
    return pixels;
  }
  for (int y = static_cast<int>(std::ceil(place.y() - ry)); y <= place.y() + ry; ++y) {
    for (int x = static_cast<int>(std::ceil(place.x() - rx)); x <= place.x() + rx; ++x) {
      const Eigen::Vector2d offset = Eigen::Vector2d(x, y) - place;
      const Eigen::Vector2d on_grid = grid_from_image * offset;
      const Eigen::Vector2d off_edges = on_grid.cwiseAbs();
      const Eigen::Vector2d inwards = lone.x() == 0 ? off_edges : on_grid.cwiseProduct(lone);
      if (off_edges.maxCoeff() > kCornerReach || inwards.minCoeff() > clear) continue;
      if (offset.squaredNorm() > kMostPx * kMostPx) continue;
      pixels.push_back({offset.x(), offset.y(), grey.at<float>(y, x)});
    }
  }
  return pixels;
}

// Across the edge that runs along `edge`, towards `towards`.
double AngleAcross(const Eigen::Vector2d& edge, const Eigen::Vector2d& towards) {
  Eigen::Vector2d normal(-edge.y(), edge.x());
  if (normal.dot(towards) < 0) normal = -normal;
  return std::atan2(normal.y(), normal.x());
}

// Of the edge that runs along `step` and bends by `bend` over it, towards AngleAcross.
double Curvature(double angle_across, const Eigen::Vector2d& step, const Eigen::Vector2d& bend) {
  return Eigen::Vector2d(std::cos(angle_across), std::sin(angle_across)).dot(bend) /
         step.squaredNorm();
}

struct Solution {
  Unknowns unknowns;
  Equations at;
  bool good = false;
};

// Levenberg-Marquardt from `start`.
Solution Solve(const std::vector<Pixel>& pixels, const Unknowns& start, const Fixed& fixed,
               double spacing) {
  Solution s{start, EquationsAt(pixels, start, fixed), false};
  double damping = 1e-3;
  for (int round = 0; round < kRounds; ++round) {
    Normal damped = s.at.normal;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-12;
    const Unknowns step = SolveSymmetric(damped, s.at.right);
    Unknowns next = s.unknowns + step;
    next[4] = std::clamp(next[4], kLeastBlur, 0.5 * spacing);
    const Equations there = EquationsAt(pixels, next, fixed);
    if (!(there.squares < s.at.squares)) {
      if (damping > 1e3) break;
      damping *= 10;
      continue;
    }
    s.unknowns = next;
    s.at = there;
    damping = std::max(1e-7, 0.1 * damping);
    if (next.head<2>().norm() > kMostShift * spacing) return s;
    if (step.head<2>().norm() < 1e-4) break;
  }
  s.good = true;
  return s;
}

// With contrast and background that fit best.
Unknowns Start(const std::vector<Pixel>& pixels, const Eigen::Matrix2d& steps, double blur,
               const Fixed& fixed) {
  Unknowns u = Unknowns::Zero();
  u[2] = AngleAcross(steps.col(1), steps.col(0));
  u[3] = AngleAcross(steps.col(0), steps.col(1));
  u[4] = blur;
  Fixed all = fixed;
  all.shape = all.cubic = false;
  const Equations at = EquationsAt(pixels, u, all);
  const Eigen::Matrix<double, kLinear, kLinear> normal =
      at.normal.bottomRightCorner<kLinear, kLinear>();
  const Eigen::Matrix<double, kLinear, 1> right = at.right.tail<kLinear>();
  u.tail<kLinear>() = SolveSymmetric(normal, right);
  return u;
}

double HalfRange(const std::vector<Pixel>& pixels, double level) {
  const auto [low, high] =
      std::minmax_element(pixels.begin(), pixels.end(),
                          [](const Pixel& a, const Pixel& b) { return a.value < b.value; });
  return 0.5 * (std::min(high->value, level) - low->value);
}

// Of a value, from what the fit leaves over.
double VarianceOf(const Solution& s, const Fixed& fixed) {
  return s.at.unexplained / (s.at.values - (fixed.cubic ? kUnknowns - kCubic : kUnknowns));
}

// With bounds among the pixels: the noise decides what these say, and is known afterwards.
Solution SolveWithBounds(const std::vector<Pixel>& pixels, Solution s, double spacing,
                         double half_range, Fixed* fixed) {
  for (int round = 0; s.good && round < kNoiseRounds; ++round) {
    const double variance = std::max(0.0, VarianceOf(s, *fixed));
    fixed->noise = std::clamp(std::sqrt(variance), kLeastNoise * half_range, half_range);
    s = Solve(pixels, s.unknowns, *fixed, spacing);
  }
  return s;
}

// Half of light minus dark, as far as the image shows it.
double ContrastOf(const Unknowns& u, const Fixed& fixed) {
  const bool lone = fixed.lone.x() != 0;
  const double middle = lone ? u[6] + u[5] : u[6];
  const double dark = middle - std::abs(u[5]);
  if (middle + std::abs(u[5]) <= fixed.level) return u[5];
  return std::copysign(0.5 * (fixed.level - dark), u[5]);
}

}  // namespace

Eigen::Vector2d CornerReach(const Eigen::Matrix2d& steps) {
  return (kCornerReach * steps.cwiseAbs().rowwise().sum()).cwiseMin(kMostPx);
}

std::optional<CornerFit> FitCorner(const cv::Mat& grey, const Eigen::Vector2d& place,
                                   const Eigen::Matrix2d& steps, const Eigen::Matrix2d& bends,
                                   std::optional<double> blur_px, double saturated_from,
                                   double clear, const LonePatch& lone) {
  const double spacing = steps.colwise().norm().minCoeff();
  if (!(spacing > 3) || !(std::abs(steps.determinant()) > 0.2 * spacing * spacing)) {
    return std::nullopt;
  }
  const std::vector<Pixel> pixels = PixelsRound(grey, place, steps, clear, lone);
  const auto values = std::count_if(pixels.begin(), pixels.end(),
                                    [&](const Pixel& p) { return p.value < saturated_from; });
  if (values < 2 * kUnknowns) return std::nullopt;
  const double blur = std::clamp(blur_px.value_or(1), kLeastBlur, 0.5 * spacing);
  Fixed fixed;
  fixed.level = saturated_from;
  fixed.lone = lone;
  const double half_range = HalfRange(pixels, saturated_from);
  fixed.noise = kFirstNoise * half_range;
  fixed.shape = blur_px.has_value();
  fixed.curvature1 = Curvature(AngleAcross(steps.col(1), steps.col(0)), steps.col(1), bends.col(1));
  fixed.curvature2 = Curvature(AngleAcross(steps.col(0), steps.col(1)), steps.col(0), bends.col(0));
  Solution s = Solve(pixels, Start(pixels, steps, blur, fixed), fixed, spacing);
  const bool bounds = values < static_cast<std::ptrdiff_t>(pixels.size());
  if (bounds) s = SolveWithBounds(pixels, s, spacing, half_range, &fixed);
  if (fixed.shape &&
      !bounds) {  // a background that bends more sharply, where the pixels clearly say so
    Fixed third = fixed;
    third.cubic = false;
    const Solution bent = Solve(pixels, s.unknowns, third, spacing);
    const double gain = (s.at.squares - bent.at.squares) / kCubic;
    if (bent.good && gain > 4 * VarianceOf(bent, third)) {
      s = bent;
      fixed = third;
    }
  }
  if (!s.good) return std::nullopt;
  CornerFit fit;
  fit.place = place + s.unknowns.head<2>();
  fit.contrast = ContrastOf(s.unknowns, fixed);
  fit.saturated = bounds;
  fit.blur_px = s.unknowns[4];
  const double variance = VarianceOf(s, fixed);
  if (!(variance < fit.contrast * fit.contrast)) return std::nullopt;  // not much of a corner
  fit.residual = std::sqrt(variance) / std::abs(fit.contrast);
  const Normal inverse = InverseOfSymmetric(s.at.normal);
  const Eigen::Matrix2d covariance = variance * inverse.topLeftCorner<2, 2>();
  fit.sigma_px = std::sqrt(std::max(0.0, EigensystemOf(covariance).values[1]));
  return std::isfinite(fit.sigma_px) ? std::optional(fit) : std::nullopt;
}

}  // namespace rgbdt
