#include "calib/detect/image/plain_board.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/camera/outline_pose.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/internal/board_sides.h"
#include "calib/detect/image/internal/grey_image.h"
#include "calib/detect/image/internal/quadrangles.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using Sides = std::array<ImageSide, 4>;

constexpr double kRoughPlaceM = 0.01;  // a rough outline is off by its shadows, too
constexpr double kMostRoughChi2 = 40;  // of two degrees of freedom
constexpr double kMostChi2 = 60;       // above: not the target's size
constexpr double kLeastSecondChi2 = 15;
constexpr double kMostTilt = 1.15;  // [rad] between the board's normal and the line of sight
// Plain boards are sawn, not printed: by how much each end of a side is off its place.
constexpr double kSawnM = 0.0015;
// What is four times too bright for the sensor looks larger by 0.9 px at each side, ten times by
// 1.6 px, of an edge blurred by 1.3 px in all: where the unsaturated part of it is steepest. All
// sides alike, while sides are held to be off one by one: 1.4 times as much.
constexpr double kSaturatedPx = 1.4;
constexpr int kRounds = 3;

Sides RoughSides(const Quadrangle& quadrangle, std::size_t first, double sigma_px) {
  Sides sides;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& seen = quadrangle.seen[(i + first) % 4];
    sides[i].seen = true;
    sides[i].curve = {seen[0], seen[1]};
    sides[i].covariance = sigma_px * sigma_px * Eigen::Matrix2d::Identity();
  }
  return sides;
}

bool SeenFromInFront(const Rigid3& camera_from_target) {
  const Eigen::Vector3d normal = camera_from_target.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& centre = camera_from_target.translation;
  return normal.dot(centre.normalized()) > std::cos(kMostTilt);
}

// Both ways in which the board may lean, by the sides, the likelier first.
std::vector<OutlinePose> PosesOf(const Camera& camera, const Target& target, const Sides& sides,
                                 const std::vector<Rigid3>& starts, double place_m) {
  std::vector<OutlinePose> poses;
  for (const Rigid3& start : starts) {
    const auto pose = PoseFromSides(camera, target, sides, start, place_m);
    if (pose && SeenFromInFront(pose->pose.sensor_from_target)) poses.push_back(*pose);
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const OutlinePose& a, const OutlinePose& b) { return a.chi2 < b.chi2; });
  return poses;
}

// A quadrangle's poses, its corners told from any of the four that the outline cannot tell apart.
std::vector<Rigid3> RoughPoses(const Camera& camera, const Target& target,
                               const Quadrangle& quadrangle, double sigma_px) {
  const auto outline = target.OutlineCorners();
  const std::vector<Eigen::Vector3d> model(outline.begin(), outline.end());
  std::vector<OutlinePose> found;
  for (std::size_t first = 0; first < 2; ++first) {  // a square's second is the first again
    std::vector<Eigen::Vector3d> corners(quadrangle.corners.begin(), quadrangle.corners.end());
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first),
                corners.end());
    const auto poses = PosesOf(camera, target, RoughSides(quadrangle, first, sigma_px),
                               PlanarPoses(model, corners), kRoughPlaceM);
    if (!poses.empty() && (found.empty() || poses.front().chi2 < found.front().chi2)) found = poses;
  }
  std::vector<Rigid3> out;
  for (const OutlinePose& pose : found) {
    if (pose.chi2 < kMostRoughChi2) out.push_back(pose.pose.sensor_from_target);
  }
  return out;
}

std::string WhyNotSeen(const Sides& sides) {
  const auto unseen =
      std::find_if(sides.begin(), sides.end(), [](const ImageSide& side) { return !side.seen; });
  return unseen == sides.end() ? "" : "a side of the board cannot be measured: " + unseen->why;
}

// A quadrangle's longer side over its shorter one, were it a rectangle (Zhang and He 2007): four
// directions d fix the corners' depths by l1 d1 - l2 d2 + l3 d3 - l4 d4 = 0.
double LongerOverShorter(const Quadrangle& quadrangle) {
  const auto& d = quadrangle.corners;
  Eigen::Matrix3d others;
  others << d[1], -d[2], d[3];
  const Eigen::Vector3d depths = others.fullPivLu().solve(d[0]);
  const double a = (depths[0] * d[1] - d[0]).norm();
  const double b = (depths[2] * d[3] - d[0]).norm();
  return std::max(a, b) / std::min(a, b);
}

double LongerOverShorter(const Target& target) {
  return std::max(target.width_m, target.height_m) / std::min(target.width_m, target.height_m);
}

// Of another shape, its shorter side kept.
Target Shaped(Target target, double longer_over_shorter) {
  const bool wide = target.width_m >= target.height_m;
  (wide ? target.width_m : target.height_m) =
      longer_over_shorter * (wide ? target.height_m : target.width_m);
  return target;
}

// Whether a quadrangle of another shape may be the board all the same, given wrong; farther off it
// is some other thing.
bool NearlyTheTargets(double shape, double targets) {
  constexpr double kLeast = 1.03, kMost = 1.25;
  const double off = std::max(shape, targets) / std::min(shape, targets);
  return off > kLeast && off < kMost;
}

double SigmaOf(const Sides& sides) {
  double sum = 0;
  for (const ImageSide& side : sides) sum += 0.5 * side.covariance.trace();
  return std::sqrt(sum / 4);
}

class Measurement {
 public:
  Measurement(const cv::Mat& grey, const cv::Mat& clipped, const Camera& camera,
              const Target& target)
      : grey_(grey), clipped_(clipped), camera_(camera), target_(target) {
    // The rim of a plain board is not told from its front: what it hides is in the sides' sigma.
    options_.max_thickness_px = 1e9;
    options_.max_sigma_px = 8;
    options_.saturated_px = kSaturatedPx;
    options_.size_tolerance_m = 0.02;  // its lens and its rim may hide more than its pose knows
  }

  PlainBoardResult From(const Quadrangle& quadrangle) const {
    const double sigma = QuadrangleSigmaPx(grey_);
    const std::vector<Rigid3> rough = RoughPoses(camera_, target_, quadrangle, sigma);
    if (rough.empty()) return {std::nullopt, "its outlines are not of the target's size"};
    auto pose = PoseFromSides(camera_, target_, RoughSidesOf(quadrangle, rough.front(), sigma),
                              rough.front(), kRoughPlaceM);
    PlainBoard board;
    for (int round = 0; round < kRounds; ++round) {
      if (!pose) return {std::nullopt, "its outline does not fit a flat board"};
      board.sides = FitBoardSides(grey_, clipped_, camera_, target_, pose->pose, options_);
      const std::string why = WhyNotSeen(board.sides);
      if (!why.empty()) return {std::nullopt, why};
      pose = PoseFromSides(camera_, target_, board.sides, pose->pose.sensor_from_target, kSawnM);
    }
    if (!pose) return {std::nullopt, "its outline does not fit a flat board"};
    return Judge(rough, *pose, std::move(board));
  }

 private:
  // From the corner that the pose calls the first.
  Sides RoughSidesOf(const Quadrangle& quadrangle, const Rigid3& pose, double sigma) const {
    std::size_t best = 0;
    double nearest = 1e9;
    for (std::size_t first = 0; first < 4; ++first) {
      const Eigen::Vector3d corner = (pose * target_.OutlineCorners()[0]).normalized();
      const double off = (corner - quadrangle.corners[first]).norm();
      if (off >= nearest) continue;
      nearest = off;
      best = first;
    }
    return RoughSides(quadrangle, best, sigma);
  }

  PlainBoardResult Judge(const std::vector<Rigid3>& rough, const OutlinePose& pose,
                         PlainBoard board) const {
    if (pose.chi2 > kMostChi2) {
      return {
          std::nullopt,
          Format("an outline does not have the target's size (chi-square %.0f of 2)", pose.chi2)};
    }
    const double scale = std::max(1.0, pose.chi2 / 2);
    for (const OutlinePose& other : PosesOf(camera_, target_, board.sides, rough, kSawnM)) {
      const bool same =
          RotationDistance(other.pose.sensor_from_target, pose.pose.sensor_from_target) < 0.01;
      if (!same && other.chi2 - pose.chi2 < kLeastSecondChi2 * scale) {
        return {std::nullopt, "the outline does not tell which way the board leans; come nearer"};
      }
    }
    board.pose = pose.pose;
    board.pose.covariance *= scale;
    for (std::size_t i = 0; i < 4; ++i) board.sides[i].covariance = pose.side_covariance[i];
    board.side_sigma_px = SigmaOf(board.sides);
    return {std::move(board), ""};
  }

  const cv::Mat& grey_;
  const cv::Mat& clipped_;
  const Camera& camera_;
  const Target& target_;
  BoardSidesOptions options_;
};

// Where all that is wrong with an outline is its shape: width and height may be given wrong, or fx
// and fy, which stretch an image alike.
std::string WhyOfOtherShape(const cv::Mat& grey, const cv::Mat& clipped, const Camera& camera,
                            const Target& target, const std::vector<Quadrangle>& quadrangles) {
  const double targets = LongerOverShorter(target);
  for (const Quadrangle& quadrangle : quadrangles) {
    const double shape = LongerOverShorter(quadrangle);
    if (!NearlyTheTargets(shape, targets)) continue;
    const Target shaped = Shaped(target, shape);
    if (!Measurement(grey, clipped, camera, shaped).From(quadrangle).board) continue;
    return Format(
        "an outline does not have the target's size: its sides are as %.2f to 1, by the rig file "
        "as %.2f to 1; if it is the board, measure it (width_m, height_m) and check the lens in "
        "the rig (fx against fy)",
        shape, targets);
  }
  return "";
}

std::string WhyLensMatters(const Camera& camera) {
  const std::string why = WhyLensIsUnlikely(camera);
  return why.empty() ? "" : "; check the lens in the rig: " + why;
}

// The first that is the board, or why the first is not.
PlainBoardResult FirstBoard(const Measurement& measurement,
                            const std::vector<Quadrangle>& quadrangles) {
  PlainBoardResult result{std::nullopt,
                          "no quadrangle in the image; are all four sides of the board in view, at "
                          "least in part, before something of another brightness or colour?"};
  for (std::size_t i = 0; i < quadrangles.size(); ++i) {
    PlainBoardResult one = measurement.From(quadrangles[i]);
    if (one.board) return one;
    if (i == 0) result.why = one.why;
  }
  return result;
}

}  // namespace

PlainBoardResult FindPlainBoard(const cv::Mat& grey,
                                const std::function<std::vector<cv::Mat>()>& colours,
                                const cv::Mat& clipped, const Camera& camera,
                                const Target& target) {
  const std::string useless = WhyImageIsUseless(grey);
  if (!useless.empty()) return {std::nullopt, useless};
  const cv::Mat repaired = RepairDeadPixels(grey);
  const Measurement measurement(repaired, clipped, camera, target);
  const std::vector<Quadrangle> quadrangles = FindQuadrangles(repaired, camera);
  PlainBoardResult result = FirstBoard(measurement, quadrangles);
  if (result.board) return result;
  for (const cv::Mat& colour : colours()) {
    PlainBoardResult found = FirstBoard(measurement, FindQuadrangles(colour, camera));
    if (found.board) return found;
  }
  const std::string other = WhyOfOtherShape(repaired, clipped, camera, target, quadrangles);
  if (!other.empty()) result.why = other;
  result.why += WhyLensMatters(camera);
  return result;
}

}  // namespace rgbdt
