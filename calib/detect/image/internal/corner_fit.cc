#include "calib/detect/image/internal/corner_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr int kUnknowns = 16;
constexpr int kLinear = 11;         // the last ones: contrast and b
constexpr int kCubic = 4;           // the last ones of these: only where the rest does not do
constexpr double kReach = 0.75;     // of the distance to the next corner
constexpr double kMostPx = 10;      // edges are straight enough and blur is seen within that
constexpr double kMostShift = 0.3;  // of the distance to the next corner
constexpr int kRounds = 20;
constexpr double kLeastBlur = 0.4;  // [px]: a pixel's own area

// x y, two angles, blur, contrast, 1 x y, xx xy yy, xxx xxy xyy yyy
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct Pixel {
  double x, y, value;  ///< place against where the search began
};

struct Equations {
  Normal normal = Normal::Zero();
  Unknowns right = Unknowns::Zero();
  double squares = 0;
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
  bool shape = false;                     ///< angles and blur stay as they are
  bool cubic = true;                      ///< and so do b's terms of third degree
  double curvature1 = 0, curvature2 = 0;  ///< of the edges, towards rising e1 and e2 [1/px]
};

Equations EquationsAt(const std::vector<Pixel>& pixels, const Unknowns& u, Fixed fixed) {
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
    const double g1 = u[5] * first.slope * second.value;
    const double g2 = u[5] * first.value * second.slope;
    Unknowns j;
    j << -(g1 * c1 + g2 * c2), -(g1 * s1 + g2 * s2), g1 * t1, g2 * t2, -(g1 * e1 + g2 * e2) / u[4],
        first.value * second.value, 1, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y, p.x * p.x * p.x,
        p.x * p.x * p.y, p.x * p.y * p.y, p.y * p.y * p.y;
    if (fixed.shape) j.segment<3>(2).setZero();
    if (fixed.cubic) j.tail<kCubic>().setZero();
    const double residual = p.value - j.tail<kLinear>().dot(u.tail<kLinear>());
    if (fixed.cubic) {  // the rest is zero
      constexpr int kUsed = kUnknowns - kCubic;
      sums.normal.topLeftCorner<kUsed, kUsed>().selfadjointView<Eigen::Lower>().rankUpdate(
          j.head<kUsed>());
    } else {
      sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(j);
    }
    sums.right += residual * j;
    sums.squares += residual * residual;
  }
  sums.normal = sums.normal.selfadjointView<Eigen::Lower>();
  if (fixed.shape) sums.normal.diagonal().segment<3>(2).setOnes();
  if (fixed.cubic) sums.normal.diagonal().tail<kCubic>().setOnes();
  return sums;
}

std::vector<Pixel> PixelsRound(const cv::Mat& grey, const Eigen::Vector2d& place,
                               const Eigen::Matrix2d& steps) {
  std::vector<Pixel> pixels;
  const Eigen::Matrix2d grid_from_image = steps.inverse();
  const Eigen::Vector2d half = kReach * steps.cwiseAbs().rowwise().sum();
  const double rx = std::min(half.x(), kMostPx);
  const double ry = std::min(half.y(), kMostPx);
  if (place.x() < rx || place.y() < ry || place.x() > grey.cols - 1 - rx ||
      place.y() > grey.rows - 1 - ry) {
    return pixels;
  }
  for (int y = static_cast<int>(std::ceil(place.y() - ry)); y <= place.y() + ry; ++y) {
    for (int x = static_cast<int>(std::ceil(place.x() - rx)); x <= place.x() + rx; ++x) {
      const Eigen::Vector2d offset = Eigen::Vector2d(x, y) - place;
      if ((grid_from_image * offset).cwiseAbs().maxCoeff() > kReach) continue;
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
Solution Solve(const std::vector<Pixel>& pixels, const Unknowns& start, Fixed fixed,
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

}  // namespace

std::optional<CornerFit> FitCorner(const cv::Mat& grey, const Eigen::Vector2d& place,
                                   const Eigen::Matrix2d& steps, const Eigen::Matrix2d& bends,
                                   std::optional<double> blur_px) {
  const double spacing = steps.colwise().norm().minCoeff();
  if (!(spacing > 3) || !(std::abs(steps.determinant()) > 0.2 * spacing * spacing)) {
    return std::nullopt;
  }
  const std::vector<Pixel> pixels = PixelsRound(grey, place, steps);
  if (pixels.size() < 2 * kUnknowns) return std::nullopt;
  const double blur = std::clamp(blur_px.value_or(1), kLeastBlur, 0.5 * spacing);
  Fixed fixed;
  fixed.shape = blur_px.has_value();
  fixed.curvature1 = Curvature(AngleAcross(steps.col(1), steps.col(0)), steps.col(1), bends.col(1));
  fixed.curvature2 = Curvature(AngleAcross(steps.col(0), steps.col(1)), steps.col(0), bends.col(0));
  Solution s = Solve(pixels, Start(pixels, steps, blur, fixed), fixed, spacing);
  auto spare = static_cast<double>(pixels.size()) - (kUnknowns - kCubic);
  if (fixed.shape) {  // a background that bends more sharply, where the pixels clearly say so
    fixed.cubic = false;
    const Solution bent = Solve(pixels, s.unknowns, fixed, spacing);
    const double gain = (s.at.squares - bent.at.squares) / kCubic;
    if (bent.good && gain > 4 * bent.at.squares / (spare - kCubic)) {
      s = bent;
      spare -= kCubic;
    }
  }
  if (!s.good) return std::nullopt;
  CornerFit fit;
  fit.place = place + s.unknowns.head<2>();
  fit.contrast = s.unknowns[5];
  fit.blur_px = s.unknowns[4];
  const double variance = s.at.squares / spare;
  if (!(variance < fit.contrast * fit.contrast)) return std::nullopt;  // not much of a corner
  fit.residual = std::sqrt(variance) / std::abs(fit.contrast);
  const Normal inverse = InverseOfSymmetric(s.at.normal);
  const Eigen::Matrix2d covariance = variance * inverse.topLeftCorner<2, 2>();
  fit.sigma_px = std::sqrt(std::max(0.0, EigensystemOf(covariance).values[1]));
  return std::isfinite(fit.sigma_px) ? std::optional(fit) : std::nullopt;
}

}  // namespace rgbdt
