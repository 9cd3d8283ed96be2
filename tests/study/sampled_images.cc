#include "tests/study/sampled_images.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calib/camera/camera.h"

namespace rgbdt::study {
namespace {

double SumOfSquares(const std::vector<Eigen::Vector2d>& corners,
                    const std::vector<Eigen::Vector2d>& truth, bool turned) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (corners[turned ? truth.size() - 1 - i : i] - truth[i]).squaredNorm();
  }
  return sum;
}

}  // namespace

double CornerSigma(CameraKind kind) {
  return kind == CameraKind::kColor ? 0.0117 : 0.0119;  // of 72 rendered scenes
}

CameraSpec SpecOf(const simulate::CameraOptions& camera) {
  CameraSpec spec;
  spec.name = camera.name;
  spec.kind = camera.kind;
  spec.width = camera.width;
  spec.height = camera.height;
  spec.lens = camera.lens;
  return spec;
}

std::optional<std::vector<Eigen::Vector2d>> TrueCorners(const CameraSpec& spec,
                                                        const Target& target,
                                                        const Rigid3& camera_from_target) {
  const Camera camera(spec);
  for (const Eigen::Vector3d& corner : target.OutlineCorners()) {
    const auto pixel = camera.Project(camera_from_target * corner);
    if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
  }
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& corner : target.InnerCorners()) {
    const auto pixel = camera.Project(camera_from_target * corner);
    if (!pixel) return std::nullopt;
    corners.push_back(*pixel);
  }
  return corners;
}

std::vector<Eigen::Vector2d> SampledCorners(const std::vector<Eigen::Vector2d>& corners,
                                            double sigma_px, const simulate::Noise& noise) {
  // Corners of one image err a little alike, which is what tells in the board's pose: an affine
  // part, in shares of sigma.
  constexpr double kShift = 0.16;
  constexpr double kSlope = 0.28;  // over half of the pattern
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  std::uint64_t index = 0;
  const auto normal = [&] { return sigma_px * noise.Normal(index++); };
  const Eigen::Vector2d shift(kShift * normal(), kShift * normal());
  Eigen::Matrix2d slope;
  slope << kSlope * normal(), kSlope * normal(), kSlope * normal(), kSlope * normal();
  std::vector<Eigen::Vector2d> sampled;
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d place = 2 * (corner - box.center()).cwiseQuotient(box.sizes());
    const Eigen::Vector2d own(normal(), normal());
    sampled.push_back(corner + own + shift + slope * place);
  }
  if (noise.Uniform(index) < 0.5) std::reverse(sampled.begin(), sampled.end());
  return sampled;
}

double CornerRms(const std::vector<Eigen::Vector2d>& corners,
                 const std::vector<Eigen::Vector2d>& truth) {
  const double sum =
      std::min(SumOfSquares(corners, truth, false), SumOfSquares(corners, truth, true));
  return std::sqrt(sum / (2.0 * static_cast<double>(truth.size())));
}

}  // namespace rgbdt::study
