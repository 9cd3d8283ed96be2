#include "calib/model/lens.h"

#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr Eigen::Index kDistortion = 4;  // where it begins among the numbers

// 1 sigma of what published lenses are off by.
constexpr double kFocal = 0.005;      // of fx and fy together, a part of them
constexpr double kAspect = 0.001;     // of each of them apart
constexpr double kCentre = 0.006;     // of the image's width
constexpr double kRadial = 0.005;     // of a pixel's distance from the middle, by the distortion
constexpr double kTangential = 1e-3;  // p1, p2
constexpr double kCoefficient = 0.5;  // a radial one: no lens's is larger by much

// Of so many radial coefficients: each by itself hardly known, all together by what they do to
// pixels from near the middle to the image's corner. The first moves a pixel at the radius r (over
// the focal length) by r^3, the next by r^5, ...
Eigen::MatrixXd RadialCovariance(Eigen::Index count, double most_radius) {
  constexpr int kRadii = 8;
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Identity(count, count) / (kCoefficient * kCoefficient);
  for (int i = 1; i <= kRadii; ++i) {
    const double r2 = std::pow(most_radius * i / kRadii, 2);
    Eigen::VectorXd share(count);  // of the radius
    for (Eigen::Index k = 0; k < count; ++k) share[k] = std::pow(r2, k + 1);
    information += share * share.transpose() / (kRadii * kRadial * kRadial);
  }
  return InverseOfSymmetric(information);
}

}  // namespace

bool operator==(const Lens& a, const Lens& b) {
  return a.model == b.model && NumbersOf(a) == NumbersOf(b) && a.distortion == b.distortion;
}

LensNumbers NumbersOf(const Lens& lens) {
  LensNumbers numbers;
  numbers << lens.fx, lens.fy, lens.cx, lens.cy, LensNumbers::Zero().tail<5>();
  for (std::size_t i = 0; i < 5; ++i) {
    numbers[kDistortion + static_cast<Eigen::Index>(i)] = lens.distortion[i];
  }
  return numbers;
}

Lens WithNumbers(Lens lens, const LensNumbers& numbers) {
  lens.fx = numbers[0];
  lens.fy = numbers[1];
  lens.cx = numbers[2];
  lens.cy = numbers[3];
  for (std::size_t i = 0; i < 5; ++i) {
    lens.distortion[i] = numbers[kDistortion + static_cast<Eigen::Index>(i)];
  }
  return lens;
}

std::vector<std::string> NamesOfNumbers(Lens::Model model) {
  if (model == Lens::Model::kFisheye) return {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
  return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
}

Eigen::Vector2d MiddleOf(const std::vector<Eigen::Vector2d>& corners) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double seen = 0;
  for (const Eigen::Vector2d& corner : corners) {
    if (!corner.allFinite()) continue;
    sum += corner;
    seen += 1;
  }
  return sum / seen;
}

LensUncertainty UsualLensUncertainty(const Lens& lens, int width, int height) {
  LensUncertainty usual;
  LensCovariance& c = usual.covariance;
  const Eigen::Vector2d focal(lens.fx, lens.fy);
  c.topLeftCorner<2, 2>() = kFocal * kFocal * focal * focal.transpose();
  c.diagonal().head<2>() += kAspect * kAspect * focal.cwiseAbs2();
  c.diagonal().segment<2>(2).setConstant(kCentre * width * kCentre * width);
  // A lens that bends outwards looks farther than its image's corner has it without distortion.
  constexpr double kBeyond = 1.25;
  const double most_radius = kBeyond * 0.5 * std::hypot(width / lens.fx, height / lens.fy);
  if (lens.model == Lens::Model::kFisheye) {
    c.block<4, 4>(kDistortion, kDistortion) = RadialCovariance(4, most_radius);
    return usual;
  }
  c.diagonal().segment<2>(kDistortion + 2).setConstant(kTangential * kTangential);
  const std::array<Eigen::Index, 3> radial{kDistortion, kDistortion + 1, kDistortion + 4};
  c(radial, radial) = RadialCovariance(3, most_radius);
  return usual;
}

PoseAndLensCovariance WithExactLens(const Matrix6d& covariance) {
  PoseAndLensCovariance out = PoseAndLensCovariance::Zero();
  out.topLeftCorner<6, 6>() = covariance;
  return out;
}

}  // namespace rgbdt
