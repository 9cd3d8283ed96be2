#include "calib/detect/image/internal/board_sides.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "calib/detect/image/internal/edge_profiles.h"
#include "calib/detect/image/internal/side_line.h"
#include "calib/model/check.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr double kInnerEdgeReachPx = 2.5;  // how far the pattern's own edge reaches when blurred
constexpr double kCornerPx = 3;            // at a side's ends the other side's edge is near
// A black background whose noise is cut off at zero moves the edge of something hardly brighter.
constexpr double kDarkPx = 0.09;
constexpr double kBiasPx = 0.015;  // of a fit, however many profiles: see board_sides_test

// Where a side lies on the target, and where the image has it.
struct Prediction {
  Eigen::Vector3d from{0, 0, 0}, to{0, 0, 0};  // target frame
  Eigen::Vector3d inwards{0, 0, 0};            // unit, target frame
  double border_m = 0;                         // from the side to the pattern
  Curve curve;                                 // [px], normals outwards
  double length_px = 0;
};

struct Pixels {
  cv::Mat grey, clipped;
  double noise = 0;  // of grey
};

struct Reach {
  double inner_px = 0, outer_px = 0;
  double border_px = 0, thickness_px = 0;
};

std::string Percent(double share) { return std::to_string(std::lround(100 * share)) + "%"; }

std::string OneDecimal(double value) {
  const std::string text = std::to_string(std::round(10 * value) / 10);
  return text.substr(0, text.find('.') + 2);
}

Prediction SideOnTarget(const Target& target, std::size_t side) {
  const auto corners = target.OutlineCorners();
  Prediction p;
  p.from = corners[side];
  p.to = corners[(side + 1) % 4];
  const Eigen::Vector3d along = (p.to - p.from).normalized();
  p.inwards = {-along.y(), along.x(), 0};
  const Eigen::Vector2d half = 0.5 * target.PatternSize();
  const double pattern =
      p.inwards.cwiseAbs().head<2>().dot(half) - p.inwards.head<2>().dot(target.pattern_offset_m);
  p.border_m = p.inwards.head<2>().dot(-p.from.head<2>()) - pattern;
  return p;
}

// The longest part of a side that lies in the image, clear of its border; none: unchanged.
void KeepInside(const Camera& camera, const Rigid3& camera_from_target, Prediction* p) {
  constexpr int kFine = 1000;
  constexpr double kBorderPx = 4;
  const Eigen::Vector2d margin(kBorderPx, kBorderPx);
  int best_first = 0;
  int best = 0;
  int first = 0;
  for (int i = 0; i <= kFine; ++i) {
    const Eigen::Vector3d at = p->from + i * (p->to - p->from) / kFine;
    const auto pixel = camera.Project(camera_from_target * at);
    if (!pixel || !camera.Contains(*pixel - margin) || !camera.Contains(*pixel + margin)) {
      first = i + 1;
    } else if (i - first > best) {
      best_first = first;
      best = i - first;
    }
  }
  if (best == 0) return;
  const Eigen::Vector3d step = (p->to - p->from) / kFine;
  p->from += best_first * step;
  p->to = p->from + best * step;
}

// Evenly in the image, though not on the board.
bool FillCurve(const Camera& camera, const Rigid3& camera_from_target, Prediction* p) {
  constexpr int kFine = 4000;
  const std::vector<Eigen::Vector2d> fine =
      ProjectSegment(camera, camera_from_target * p->from, camera_from_target * p->to, kFine);
  if (fine.size() != kFine + 1) return false;
  std::vector<double> along(fine.size(), 0.0);
  for (std::size_t i = 1; i < fine.size(); ++i) {
    along[i] = along[i - 1] + (fine[i] - fine[i - 1]).norm();
  }
  p->length_px = along.back();
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::round(p->length_px)));
  p->curve.step_px = p->length_px / static_cast<double>(pieces);
  std::size_t k = 0;
  for (std::size_t i = 0; i <= pieces; ++i) {
    const double wanted = static_cast<double>(i) * p->curve.step_px;
    while (k + 2 < along.size() && along[k + 1] < wanted) ++k;
    const Eigen::Vector2d tangent = (fine[k + 1] - fine[k]).normalized();
    p->curve.points.emplace_back(fine[k] + (wanted - along[k]) * tangent);
    p->curve.normals.emplace_back(tangent.y(), -tangent.x());  // the outline goes clockwise
  }
  return true;
}

// Displacement across the side [px] when the point of its curve nearest to `point` moves there.
double Across(const Camera& camera, const Rigid3& camera_from_target, const Prediction& p,
              bool at_end, const Eigen::Vector3d& offset) {
  const std::size_t i = at_end ? p.curve.points.size() - 1 : 0;
  const auto pixel = camera.Project(camera_from_target * ((at_end ? p.to : p.from) + offset));
  return pixel ? (*pixel - p.curve.points[i]).dot(p.curve.normals[i]) : 0;
}

// Sigma [px] of a side's end across the side, from the pose's covariance, by differences.
double PoseSigma(const Camera& camera, const TargetPose& pose, const Prediction& p, bool at_end) {
  Vector6d by_delta;
  for (int k = 0; k < 6; ++k) {
    const double step = 1e-5;
    const Rigid3 moved = Exp(step * Vector6d::Unit(k)) * pose.sensor_from_target;
    by_delta[k] = Across(camera, moved, p, at_end, {0, 0, 0}) / step;
  }
  return std::sqrt(std::max(0.0, by_delta.dot(pose.covariance * by_delta)));
}

// How far to look: as far as pose and size allow, but not to the first row of squares, whose edge
// is stronger than the outline's.
Reach ReachOf(const Camera& camera, const TargetPose& pose, const Prediction& p,
              const BoardSidesOptions& options) {
  const Rigid3& camera_from_target = pose.sensor_from_target;
  double reach = 0;
  Reach out;
  out.border_px = 1e9;
  for (const bool at_end : {false, true}) {
    const double border =
        -Across(camera, camera_from_target, p, at_end, std::max(0.0, p.border_m) * p.inwards);
    const double tolerance = std::abs(
        Across(camera, camera_from_target, p, at_end, options.size_tolerance_m * p.inwards));
    const double behind =
        Across(camera, camera_from_target, p, at_end, {0, 0, options.thickness_m});
    reach = std::max(reach, 3 * PoseSigma(camera, pose, p, at_end) + tolerance + 1);
    out.border_px = std::min(out.border_px, border);
    out.thickness_px = std::max(out.thickness_px, behind);
  }
  reach = std::min(reach, 8.0);
  out.outer_px = reach;
  // Without a border the pattern's edge is the outline.
  out.inner_px = -(p.border_m < 1e-3 ? reach : std::min(reach, out.border_px - kInnerEdgeReachPx));
  return out;
}

// The part of the curve away from the board's corners.
Curve Middle(const Curve& curve, double leave_px, std::size_t* skipped) {
  *skipped = static_cast<std::size_t>(std::ceil(leave_px / curve.step_px));
  Curve out;
  out.step_px = curve.step_px;
  if (curve.points.size() < 2 * *skipped + 3) return out;
  const auto first = static_cast<std::ptrdiff_t>(*skipped);
  out.points.assign(curve.points.begin() + first, curve.points.end() - first);
  out.normals.assign(curve.normals.begin() + first, curve.normals.end() - first);
  return out;
}

std::vector<Eigen::Vector2d> Displaced(const Curve& curve, const SideLine& line) {
  std::vector<Eigen::Vector2d> out;
  const std::size_t last = curve.points.size() - 1;
  const auto at = [&](std::size_t i) {
    const double t = static_cast<double>(i) / static_cast<double>(last);
    return Eigen::Vector2d(curve.points[i] +
                           (line.first_px + t * (line.last_px - line.first_px)) * curve.normals[i]);
  };
  for (std::size_t i = 0; i + 4 < last; i += 8) out.push_back(at(i));
  out.push_back(at(last));
  return out;
}

// The profiles without what is beside saturated pixels.
std::vector<Profile> Unsaturated(std::vector<Profile> profiles) {
  for (Profile& profile : profiles) {
    auto& edges = profile.edges;
    edges.erase(std::remove_if(edges.begin(), edges.end(),
                               [](const ProfileEdge& edge) { return edge.bright; }),
                edges.end());
  }
  return profiles;
}

// How many have an edge beside saturated pixels.
std::ptrdiff_t BrightProfiles(const std::vector<Profile>& profiles) {
  return std::count_if(profiles.begin(), profiles.end(), [](const Profile& p) {
    return std::any_of(p.edges.begin(), p.edges.end(),
                       [](const ProfileEdge& edge) { return edge.bright; });
  });
}

std::string WhyNotSeen(const std::vector<Profile>& profiles, const SideLine& line,
                       const BoardSidesOptions& options) {
  const auto inside =
      std::count_if(profiles.begin(), profiles.end(), [](const Profile& p) { return p.inside; });
  if (static_cast<double>(inside) < options.min_share * static_cast<double>(profiles.size())) {
    return "this side lies outside the image";
  }
  const auto saturated = BrightProfiles(profiles);
  if (line.share < options.min_share && 3 * saturated > inside) {
    return "the image is saturated along " +
           Percent(static_cast<double>(saturated) / static_cast<double>(inside)) + " of this side";
  }
  if (line.share < options.min_share && line.edge_share < 2 * options.min_share) {
    return "board and background look alike along " + Percent(1 - line.edge_share) +
           " of this side";
  }
  if (line.share < options.min_share || line.share < 0.5 * line.edge_share || line.rms_px > 0.6) {
    return "the edges along this side do not lie on one line";
  }
  const double sigma = std::sqrt(line.covariance.diagonal().maxCoeff());
  if (line.count < 12 || !(sigma < options.max_sigma_px)) {
    return "this side's place is only known to " + OneDecimal(sigma) + " px";
  }
  return "";
}

ImageSide FitSide(const Pixels& pixels, const Camera& camera, const Target& target,
                  const TargetPose& pose, std::size_t index, const BoardSidesOptions& options) {
  ImageSide side;
  Prediction p = SideOnTarget(target, index);
  if (target.WhiteToTheRim()) KeepInside(camera, pose.sensor_from_target, &p);
  if (!FillCurve(camera, pose.sensor_from_target, &p)) {
    side.why = "this side lies outside the image";
    return side;
  }
  const Reach reach = ReachOf(camera, pose, p, options);
  if (reach.thickness_px > options.max_thickness_px) {
    side.why =
        "the board's thickness may show here, by up to " + OneDecimal(reach.thickness_px) + " px";
    return side;
  }
  if (reach.inner_px > -0.5) {
    side.why = "the border between outline and pattern is only " + OneDecimal(reach.border_px) +
               " px wide";
    return side;
  }
  std::size_t skipped = 0;
  const Curve middle = Middle(p.curve, std::max(kCornerPx, 0.03 * p.length_px), &skipped);
  std::vector<Profile> profiles = ProfilesAcross(pixels.grey, pixels.clipped, middle,
                                                 reach.inner_px, reach.outer_px, pixels.noise);
  for (Profile& profile : profiles) {
    profile.along_px += static_cast<double>(skipped) * p.curve.step_px;
  }
  // Squares make what is beside the outline alike along their length.
  const double square_px = p.length_px * target.square_m / (p.to - p.from).norm();
  const auto fit = [&](const std::vector<Profile>& seen) {
    return FitSideLine(seen, p.length_px, reach.inner_px, reach.outer_px, std::max(8.0, square_px));
  };
  SideLine line = fit(Unsaturated(profiles));
  side.why = WhyNotSeen(profiles, line, options);
  if (!side.why.empty() && options.saturated_px > 0 && BrightProfiles(profiles) > 0) {
    line = fit(profiles);
    if (line.bright_share > 0 && WhyNotSeen(profiles, line, options).empty()) side.why.clear();
  }
  if (!side.why.empty()) return side;
  side.seen = true;
  side.curve = Displaced(p.curve, line);
  // Thickness and clipped values shift a whole side: what is unknown of them is common to both
  // ends.
  const double shift = std::hypot(0.5 * reach.thickness_px, kDarkPx * line.dark_share,
                                  options.saturated_px * line.bright_share);
  side.covariance = line.covariance + kBiasPx * kBiasPx * Eigen::Matrix2d::Identity() +
                    shift * shift * Eigen::Matrix2d::Ones();
  return side;
}

}  // namespace

void BoardSidesOptions::Check() const {
  const OptionCheck check("board sides");
  check.Require(size_tolerance_m >= 0 && size_tolerance_m < 0.1, "size_tolerance_m",
                size_tolerance_m, "0 to below 0.1 m");
  check.Require(thickness_m >= 0 && thickness_m < 0.2, "thickness_m", thickness_m,
                "0 to below 0.2 m");
  check.NotNegative(max_thickness_px, "max_thickness_px");
  check.Require(min_share > 0 && min_share <= 1, "min_share", min_share, "above 0, up to 1");
  check.Positive(max_sigma_px, "max_sigma_px");
  check.NotNegative(saturated_px, "saturated_px");
}

std::array<ImageSide, 4> FitBoardSides(const cv::Mat& grey, const cv::Mat& clipped,
                                       const Camera& camera, const Target& target,
                                       const TargetPose& camera_from_target,
                                       const BoardSidesOptions& options) {
  options.Check();
  const Pixels pixels{grey, clipped, NoiseOf(grey)};
  std::array<ImageSide, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    sides[i] = FitSide(pixels, camera, target, camera_from_target, i, options);
  }
  return sides;
}

}  // namespace rgbdt
