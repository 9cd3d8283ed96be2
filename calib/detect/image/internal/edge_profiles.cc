#include "calib/detect/image/internal/edge_profiles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/detect/image/internal/clipped.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kStep = 0.25;    // [px] between two samples of a profile
constexpr double kSmooth = 0.8;   // [px] sigma
constexpr int kReach = 4;         // [px] 5 sigma
constexpr double kStandsOut = 4;  // sigma

// Gaussian weights of the pixels about a place, in x or in y.
struct Weights {
  int first = 0;
  std::array<double, 2 * kReach> at{}, off{};  // the weight; the pixel's distance from the place
};

Weights WeightsAbout(double place) {
  Weights weights;
  weights.first = static_cast<int>(std::floor(place)) - kReach + 1;
  double sum = 0;
  for (std::size_t i = 0; i < weights.at.size(); ++i) {
    weights.off[i] = weights.first + static_cast<double>(i) - place;
    weights.at[i] = std::exp(-weights.off[i] * weights.off[i] / (2 * kSmooth * kSmooth));
    sum += weights.at[i];
  }
  for (double& weight : weights.at) weight /= sum;
  return weights;
}

// The smoothed image's slope along `normal` [per px] at a place between pixels, by the Gaussian's
// own derivative at each pixel's distance. (An interpolation's slope depends on where between the
// pixels it is taken, which would move an edge that runs along a row.)
double Slope(const cv::Mat& grey, const Eigen::Vector2d& p, const Eigen::Vector2d& normal) {
  const Weights wx = WeightsAbout(p.x());
  const Weights wy = WeightsAbout(p.y());
  const auto at = [&](int x, int y) {
    return static_cast<double>(
        grey.at<float>(std::clamp(y, 0, grey.rows - 1), std::clamp(x, 0, grey.cols - 1)));
  };
  const double middle = at(wx.first + kReach, wy.first + kReach);  // a constant has no slope
  double slope = 0;
  for (std::size_t j = 0; j < wy.at.size(); ++j) {
    for (std::size_t i = 0; i < wx.at.size(); ++i) {
      const double along = wx.off[i] * normal.x() + wy.off[j] * normal.y();
      slope += (at(wx.first + static_cast<int>(i), wy.first + static_cast<int>(j)) - middle) *
               wx.at[i] * wy.at[j] * along;
    }
  }
  return slope / (kSmooth * kSmooth);
}

bool Inside(const cv::Mat& grey, const Eigen::Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= grey.cols - 1 && p.y() <= grey.rows - 1;
}

// Sigma of the slope over the sigma of a pixel, pixels independent: of (g'(x) g(y))^2 the integral.
double NoiseGain() { return 1 / (std::sqrt(8 * kPi) * kSmooth * kSmooth); }

// Local extrema, each by the parabola through its three samples.
std::vector<ProfileEdge> ExtremaOf(const std::vector<double>& slopes, double inner_px,
                                   double noise) {
  std::vector<ProfileEdge> edges;
  for (std::size_t i = 1; i + 1 < slopes.size(); ++i) {
    const double sign = slopes[i] < 0 ? -1 : 1;
    const double before = sign * slopes[i - 1];
    const double here = sign * slopes[i];
    const double after = sign * slopes[i + 1];
    if (!(here > before && here >= after) || here < kStandsOut * noise) continue;
    const double shift = 0.5 * (before - after) / (before - 2 * here + after);
    edges.push_back(
        {inner_px + (static_cast<double>(i) + shift) * kStep, here / noise, false, false});
  }
  return edges;
}

// What Clipped() says within 3 px of an edge: the brightest that there is.
std::uint8_t ClippedNear(const cv::Mat& clipped, const Eigen::Vector2d& at,
                         const Eigen::Vector2d& normal, double offset) {
  std::uint8_t most = 0;
  for (int i = -3; i <= 3; ++i) {
    const Eigen::Vector2d p = at + (offset + i) * normal;
    const int x = std::clamp(static_cast<int>(std::lround(p.x())), 0, clipped.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(p.y())), 0, clipped.rows - 1);
    most = std::max(most, clipped.at<std::uint8_t>(y, x));
  }
  return most;
}

}  // namespace

double NoiseOf(const cv::Mat& grey) {
  constexpr int kApart = 3;
  std::vector<float> differences;
  for (int y = 0; y < grey.rows; y += 3) {
    const float* row = grey.ptr<float>(y);
    for (int x = y % 2; x + 2 * kApart < grey.cols; x += 2) {
      differences.push_back(std::abs(row[x] - 2 * row[x + kApart] + row[x + 2 * kApart]));
    }
  }
  if (differences.empty()) return 1;
  // Where an image is black through and through there is still the rounding to whole values.
  return std::hypot(static_cast<double>(Median(std::move(differences))) / (0.6745 * std::sqrt(6.0)),
                    std::sqrt(1.0 / 12));
}

std::vector<Profile> ProfilesAcross(const cv::Mat& grey, const cv::Mat& clipped, const Curve& curve,
                                    double inner_px, double outer_px, double noise) {
  const double slope_noise = std::max(NoiseGain() * noise, 1e-9);
  std::vector<double> slopes(static_cast<std::size_t>((outer_px - inner_px) / kStep) + 1);
  std::vector<Profile> profiles(curve.points.size());
  for (std::size_t k = 0; k < profiles.size(); ++k) {
    Profile& profile = profiles[k];
    const Eigen::Vector2d& at = curve.points[k];
    const Eigen::Vector2d& normal = curve.normals[k];
    profile.along_px = static_cast<double>(k) * curve.step_px;
    profile.inside =
        Inside(grey, at + (inner_px - 2) * normal) && Inside(grey, at + (outer_px + 2) * normal);
    if (!profile.inside) continue;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      slopes[i] = Slope(grey, at + (inner_px + static_cast<double>(i) * kStep) * normal, normal);
    }
    for (ProfileEdge edge : ExtremaOf(slopes, inner_px, slope_noise)) {
      const std::uint8_t beside = ClippedNear(clipped, at, normal, edge.offset_px);
      edge.dark = beside == kClippedDark;
      edge.bright = beside == kClippedBright;
      profile.edges.push_back(edge);
    }
  }
  return profiles;
}

}  // namespace rgbdt
