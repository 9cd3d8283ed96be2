#include "tests/study/sampled_images.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calib/camera/camera.h"
#include "calib/camera/target_pose.h"

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

using Chain = std::vector<Eigen::Vector2d>;

// Corners of one image err a little alike, which is what tells in the board's pose: an affine part,
// in shares of sigma.
constexpr double kShift = 0.16;
constexpr double kSlope = 0.28;  // over half of the pattern

// Each corner's place in the pattern's box in the image, -1 to 1 along x and y.
std::vector<Eigen::Vector2d> PlacesInPattern(const std::vector<Eigen::Vector2d>& corners) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector2d& corner : corners) {
    places.emplace_back(2 * (corner - box.center()).cwiseQuotient(box.sizes()));
  }
  return places;
}

// `index`: of the noise's next number.
std::vector<Eigen::Vector2d> NoisyCorners(const std::vector<Eigen::Vector2d>& corners,
                                          double sigma_px, const simulate::Noise& noise,
                                          std::uint64_t* index) {
  const std::vector<Eigen::Vector2d> places = PlacesInPattern(corners);
  const auto normal = [&] { return sigma_px * noise.Normal((*index)++); };
  const Eigen::Vector2d shift(kShift * normal(), kShift * normal());
  Eigen::Matrix2d slope;
  slope << kSlope * normal(), kSlope * normal(), kSlope * normal(), kSlope * normal();
  std::vector<Eigen::Vector2d> sampled;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d own(normal(), normal());
    sampled.emplace_back(corners[i] + own + shift + slope * places[i]);
  }
  return sampled;
}

constexpr double kPi = 3.14159265358979323846;
constexpr double kSideSigmaPx = 0.1;  // of a fitted side's end, across it
constexpr int kBandHalf = 1;          // edges of rendered images are some 4 px wide, too

// Some two points a pixel; from side 0's first corner on.
std::array<Chain, 4> OutlineChains(const Camera& camera, const TrueBoard& board,
                                   const Rigid3& camera_from_target) {
  const auto corners = board.target.OutlineCorners();
  std::array<Chain, 4> chains;
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector3d& from = corners[side];
    const Eigen::Vector3d& to = corners[(side + 1) % 4];
    const auto project = [&](const Eigen::Vector3d& flat) {
      return *camera.Project(camera_from_target * board.Bent(flat));
    };
    const int steps = std::max(8, static_cast<int>(2 * (project(to) - project(from)).norm()));
    for (int i = 0; i <= steps; ++i) {
      chains[side].push_back(project(from + static_cast<double>(i) / steps * (to - from)));
    }
  }
  return chains;
}

using Pixel = Eigen::Vector2i;

std::vector<Pixel> BandPixels(const std::array<Chain, 4>& chains) {
  std::vector<Pixel> pixels;
  for (const Chain& chain : chains) {
    for (const Eigen::Vector2d& p : chain) {
      const Pixel middle(static_cast<int>(std::lround(p.x())),
                         static_cast<int>(std::lround(p.y())));
      for (int y = -kBandHalf; y <= kBandHalf; ++y) {
        for (int x = -kBandHalf; x <= kBandHalf; ++x) pixels.emplace_back(middle + Pixel(x, y));
      }
    }
  }
  const auto before = [](const Pixel& a, const Pixel& b) {
    return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
  };
  std::sort(pixels.begin(), pixels.end(), before);
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  return pixels;
}

// A side as it is fitted: both of its ends a little off.
ImageSide FittedSide(const Chain& chain, double first_px, double last_px) {
  ImageSide side;
  side.seen = true;
  side.covariance = kSideSigmaPx * kSideSigmaPx * Eigen::Matrix2d::Identity();
  const std::size_t last = chain.size() - 1;
  for (std::size_t i = 0; i <= last; i = i == last || i + 8 < last ? i + 8 : last) {
    const Eigen::Vector2d along = chain[std::min(i + 1, last)] - chain[i == 0 ? 0 : i - 1];
    const Eigen::Vector2d normal = Eigen::Vector2d(along.y(), -along.x()).normalized();
    const double t = static_cast<double>(i) / static_cast<double>(last);
    side.curve.emplace_back(chain[i] + (first_px + t * (last_px - first_px)) * normal);
  }
  return side;
}

void AddOutline(const CameraSpec& spec, const TrueBoard& board, const Rigid3& camera_from_target,
                const simulate::Noise& noise, ImageEdges* edges) {
  const Camera camera(spec);
  const auto chains = OutlineChains(camera, board, camera_from_target);
  edges->edge_pixels = BandPixels(chains);
  for (std::size_t side = 0; side < 4; ++side) {
    edges->outline_corners[side] = chains[side].front();
    for (std::size_t k = 0; k < chains[side].size(); k += 8) {
      edges->outline.push_back(chains[side][k]);
    }
    if (spec.kind == CameraKind::kColor) {
      edges->sides[side] = FittedSide(chains[side], kSideSigmaPx * noise.Normal(2 * side),
                                      kSideSigmaPx * noise.Normal(2 * side + 1));
    } else {
      edges->sides[side].why = "not sampled";
    }
  }
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
                                                        const TrueBoard& board,
                                                        const Rigid3& camera_from_target) {
  const Camera camera(spec);
  for (const Eigen::Vector3d& corner : board.target.OutlineCorners()) {
    const auto pixel = camera.Project(camera_from_target * board.Bent(corner));
    if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
  }
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& corner : board.InnerCorners()) {
    const auto pixel = camera.Project(camera_from_target * corner);
    if (!pixel) return std::nullopt;
    corners.push_back(*pixel);
  }
  return corners;
}

Eigen::MatrixXd CornerCovariance(const std::vector<Eigen::Vector2d>& corners, double sigma_px) {
  const std::vector<Eigen::Vector2d> places = PlacesInPattern(corners);
  const auto size = 2 * static_cast<Eigen::Index>(corners.size());
  Eigen::MatrixXd alike = Eigen::MatrixXd::Zero(size, 6);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Eigen::Index row = 2 * static_cast<Eigen::Index>(i) + axis;
      alike(row, axis) = kShift;
      alike.block<1, 2>(row, 2 + 2 * axis) = kSlope * places[i].transpose();
    }
  }
  return sigma_px * sigma_px * (Eigen::MatrixXd::Identity(size, size) + alike * alike.transpose());
}

std::vector<Eigen::Vector2d> SampledCorners(const std::vector<Eigen::Vector2d>& corners,
                                            double sigma_px, const simulate::Noise& noise) {
  std::uint64_t index = 0;
  std::vector<Eigen::Vector2d> sampled = NoisyCorners(corners, sigma_px, noise, &index);
  if (noise.Uniform(index) < 0.5) std::reverse(sampled.begin(), sampled.end());
  return sampled;
}

std::optional<ImageEdges> SampledEdges(const CameraSpec& spec, const Lens& given,
                                       const TrueBoard& board, const Rigid3& camera_from_target,
                                       const simulate::Noise& noise) {
  const auto truth = TrueCorners(spec, board, camera_from_target);
  if (!truth) return std::nullopt;
  constexpr std::uint64_t kCorners = 16;  // numbers before are the sides'
  const bool color = spec.kind == CameraKind::kColor;
  ImageEdges edges;
  edges.width = spec.width;
  edges.height = spec.height;
  std::uint64_t next = kCorners;
  edges.corners = NoisyCorners(*truth, CornerSigma(spec.kind), noise, &next);
  // By their own squares' shades only colours tell the target's top from its bottom.
  const bool turned = !color && noise.Uniform(next) < 0.5;
  if (turned) std::reverse(edges.corners.begin(), edges.corners.end());
  CameraSpec with_given = spec;
  with_given.lens = given;
  Target as_squares_say = board.target;
  as_squares_say.print_scale = {1, 1};
  const auto pose = PoseFromCorners(Camera(with_given), as_squares_say, edges.corners);
  if (!pose) return std::nullopt;
  edges.pose = pose->pose;
  edges.pose->half_turn_known = color;
  edges.corner_sigma_px = pose->corner_sigma_px;
  const Rigid3 half_turn = RotationAbout(Eigen::Vector3d::UnitZ(), turned ? kPi : 0);
  AddOutline(spec, board, camera_from_target * half_turn, noise, &edges);
  return edges;
}

double CornerRms(const std::vector<Eigen::Vector2d>& corners,
                 const std::vector<Eigen::Vector2d>& truth) {
  const double sum =
      std::min(SumOfSquares(corners, truth, false), SumOfSquares(corners, truth, true));
  return std::sqrt(sum / (2.0 * static_cast<double>(truth.size())));
}

}  // namespace rgbdt::study
