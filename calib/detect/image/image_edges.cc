#include "calib/detect/image/image_edges.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/camera/pixels.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/internal/board_sides.h"
#include "calib/detect/image/internal/clipped.h"
#include "calib/detect/image/internal/colour_planes.h"
#include "calib/detect/image/internal/corner_order.h"
#include "calib/detect/image/internal/grey_image.h"
#include "calib/detect/image/internal/marked_board.h"
#include "calib/detect/image/internal/outline_by_opencv.h"
#include "calib/detect/image/internal/picked_board.h"
#include "calib/detect/image/plain_board.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr int kBandHalf = 2;  // a 5x5 window (paper II-A.1)

using Corners = std::array<Eigen::Vector2d, 4>;
using Directions = std::array<Eigen::Vector3d, 4>;  // camera axes; a side joins two of them
using Chain = std::vector<Eigen::Vector2d>;

std::string Text(const Eigen::Vector2d& p) {
  return "(" + std::to_string(std::lround(p.x())) + ", " + std::to_string(std::lround(p.y())) + ")";
}

// Picks in order round the board, not crossing.
std::string WhyNotAQuadrangle(const Corners& c) {
  int turns = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = c[(i + 1) % 4] - c[i];
    const Eigen::Vector2d b = c[(i + 2) % 4] - c[(i + 1) % 4];
    if (a.norm() < 3) {
      return "picked corners " + Text(c[i]) + " and " + Text(c[(i + 1) % 4]) +
             " are the same point; pick four different corners";
    }
    turns += a.x() * b.y() - a.y() * b.x() > 0 ? 1 : -1;
  }
  if (std::abs(turns) != 4) return "picked corners do not go round the board; pick them in order";
  return "";
}

// Where inner corners are, when only the outline is known: the same fractions of the board.
std::optional<Chain> InnerFromOutline(const Camera& camera, const Target& target,
                                      const Directions& outline) {
  std::vector<cv::Point2f> quadrangle;
  for (const Eigen::Vector3d& d : outline) {
    quadrangle.emplace_back(static_cast<float>(d.x() / d.z()), static_cast<float>(d.y() / d.z()));
  }
  const std::vector<cv::Point2f> unit = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<cv::Point2f> inner;
  for (const Eigen::Vector3d& c : target.InnerCorners()) {
    inner.emplace_back(static_cast<float>(c.x() / target.width_m + 0.5),
                       static_cast<float>(c.y() / target.height_m + 0.5));
  }
  std::vector<cv::Point2f> seen;
  cv::perspectiveTransform(inner, seen, cv::getPerspectiveTransform(unit, quadrangle));
  Chain out;
  for (const cv::Point2f& p : seen) {
    const auto pixel = camera.Project({p.x, p.y, 1.0});
    if (!pixel) return std::nullopt;
    out.push_back(*pixel);
  }
  return out;
}

struct Gradient {
  cv::Mat x, y;       // CV_32F, Sobel
  cv::Mat magnitude;  // CV_32F
  float threshold = 0;
};

// Sobel. The paper names no threshold: an edge is what stands out 4 times from the median
// magnitude, some 5 sigma where an image is mostly noise. (Matlab's rule, twice the RMS, loses a
// black border on dark ground as soon as a bright sky raises the RMS.)
Gradient SobelOf(const cv::Mat& grey) {
  Gradient g;
  cv::Sobel(grey, g.x, CV_32F, 1, 0);
  cv::Sobel(grey, g.y, CV_32F, 0, 1);
  cv::magnitude(g.x, g.y, g.magnitude);
  // Not below a step of one grey value, which Sobel shows as 4: a flat sky has no noise to go by.
  g.threshold = std::max(4.0F, 4 * Percentile(g.magnitude, 0.5));
  return g;
}

// A side as a chain of pixels about half a pixel apart.
Chain SideOf(const Camera& camera, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const auto a = camera.Project(from);
  const auto b = camera.Project(to);
  if (!a || !b) return {};
  const int pieces = std::clamp(static_cast<int>(2 * (*b - *a).norm()), 8, 20000);
  return ProjectSegment(camera, from, to, pieces);
}

std::vector<Eigen::Vector2i> EdgePixelsIn(const std::array<Chain, 4>& sides, const Gradient& g) {
  cv::Mat band = cv::Mat::zeros(g.magnitude.size(), CV_8U);
  const cv::Rect image(0, 0, band.cols, band.rows);
  for (const Chain& side : sides) {
    for (const Eigen::Vector2d& p : side) {
      const cv::Rect window(static_cast<int>(std::lround(p.x())) - kBandHalf,
                            static_cast<int>(std::lround(p.y())) - kBandHalf, 2 * kBandHalf + 1,
                            2 * kBandHalf + 1);
      const cv::Rect inside = window & image;
      if (!inside.empty()) band(inside).setTo(255);
    }
  }
  std::vector<Eigen::Vector2i> pixels;
  for (int y = 0; y < band.rows; ++y) {
    for (int x = 0; x < band.cols; ++x) {
      if (band.at<std::uint8_t>(y, x) != 0 && g.magnitude.at<float>(y, x) > g.threshold) {
        pixels.emplace_back(x, y);
      }
    }
  }
  return pixels;
}

// 0 on the last row and column and beyond: no edge is looked for there.
float InnerValue(const cv::Mat& m, const Eigen::Vector2d& p) {
  const bool inside = p.x() >= 0 && p.y() >= 0 && p.x() < m.cols - 1 && p.y() < m.rows - 1;
  return inside ? Interpolate(m, p.x(), p.y()) : 0;
}

// Offset [px] along `normal` of the steepest gradient near `p`, by a parabola through the peak.
std::optional<double> EdgeOffset(const Gradient& g, const Eigen::Vector2d& p,
                                 const Eigen::Vector2d& normal) {
  constexpr double kReach = 3.0;
  constexpr double kStep = 0.5;
  constexpr int kSteps = static_cast<int>(2 * kReach / kStep);
  std::array<double, kSteps + 1> steepness;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::Vector2d at = p + (i * kStep - kReach) * normal;
    steepness[static_cast<std::size_t>(i)] =
        std::abs(InnerValue(g.x, at) * normal.x() + InnerValue(g.y, at) * normal.y());
  }
  const auto best = std::max_element(steepness.begin(), steepness.end());
  if (best == steepness.begin() || best == steepness.end() - 1 || *best < g.threshold) {
    return std::nullopt;
  }
  const double curvature = best[-1] - 2 * best[0] + best[1];
  const double shift = curvature < 0 ? 0.5 * (best[-1] - best[1]) / curvature : 0;
  return (static_cast<double>(best - steepness.begin()) + shift) * kStep - kReach;
}

// The side moved and turned onto the image's edge: offset = a + b t, t from -1 to 1, by iteratively
// reweighted least squares. A side whose edge is seen along less than a third of it stays.
Chain FitSide(const Chain& side, const Gradient& g) {
  struct Sample {
    double t, offset;
  };
  std::vector<Sample> samples;
  const std::size_t n = side.size();
  const auto normal_at = [&](std::size_t i) {
    const Eigen::Vector2d along = side[std::min(i + 1, n - 1)] - side[i == 0 ? 0 : i - 1];
    return Eigen::Vector2d(-along.y(), along.x()).normalized();
  };
  const auto t_at = [&](std::size_t i) {
    return 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0;
  };
  if (n < 24) return side;
  std::size_t tried = 0;
  for (std::size_t i = n / 12; i < n - n / 12; i += 2) {  // the corners are another side's, too
    ++tried;
    const auto offset = EdgeOffset(g, side[i], normal_at(i));
    if (offset) samples.push_back({t_at(i), *offset});
  }
  if (samples.size() < 8 || samples.size() * 3 < tried) return side;
  double a = 0;
  double b = 0;
  for (int iteration = 0; iteration < 15; ++iteration) {
    Eigen::Matrix2d h = 1e-9 * Eigen::Matrix2d::Identity();
    Eigen::Vector2d r = Eigen::Vector2d::Zero();
    for (const Sample& s : samples) {
      const double residual = s.offset - a - b * s.t;
      const double weight = iteration == 0 ? 1 : 1 / (1 + residual * residual / 0.04);  // Cauchy
      const Eigen::Vector2d j(1, s.t);
      h += weight * j * j.transpose();
      r += weight * s.offset * j;
    }
    const Eigen::Vector2d solution = SolveSymmetric(h, r);
    a = solution.x();
    b = solution.y();
  }
  Chain fitted;
  fitted.reserve(n);
  for (std::size_t i = 0; i < n; ++i) fitted.push_back(side[i] + (a + b * t_at(i)) * normal_at(i));
  return fitted;
}

struct Located {
  Directions outline;
  Chain inner;
  std::optional<CornerPose> pose;   // not by the paper, from picks
  std::optional<PlainBoard> plain;  // of a target without a pattern
  std::string why;
};

Located FromPicks(const Camera& camera, const Target& target, const Corners& picks) {
  Located located;
  located.why = WhyNotAQuadrangle(picks);
  if (!located.why.empty()) return located;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto direction = camera.Unproject(picks[i]);
    if (!camera.Contains(picks[i]) || !direction || direction->z() < 1e-3) {
      located.why = "picked corner " + Text(picks[i]) + " lies outside the image";
      return located;
    }
    located.outline[i] = *direction / direction->z();
  }
  const auto inner = InnerFromOutline(camera, target, located.outline);
  if (!inner) {
    located.why = "picked corners do not fit a board";
    return located;
  }
  located.inner = *inner;
  return located;
}

// The outline as a pose has it.
void PlaceOutline(const Target& target, const Rigid3& camera_from_target, Located* located) {
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) located->outline[i] = camera_from_target * corners[i];
}

Located FromPlainBoard(const Image& image, const cv::Mat& grey, const Camera& camera,
                       const Target& target) {
  Located located;
  PlainBoardResult found = FindPlainBoard(
      grey, [&] { return ColourPlanes(image); }, Clipped(image), camera, target);
  located.why = std::move(found.why);
  located.plain = std::move(found.board);
  if (located.plain) {
    PlaceOutline(target, located.plain->pose.sensor_from_target, &located);
  }
  return located;
}

Located FromCheckerboard(const Image& image, const cv::Mat& grey, const Camera& camera,
                         const Target& target, CameraKind kind) {
  Located located;
  const CheckerboardResult found = MarkersMayHide(target, kind)
                                       ? FindMarkedBoard(grey, target, SaturatedFrom(image), false)
                                       : FindCheckerboard(grey, target, SaturatedFrom(image));
  if (!found.board) {
    located.why = found.why;
    return located;
  }
  located.inner = found.board->corners;
  const bool known = found.board->order_known ||
                     OrderCorners(grey, target, kind == CameraKind::kColor, &located.inner);
  located.pose = PoseFromCorners(camera, target, located.inner);
  if (!located.pose) {
    located.why = WhyNoFlatBoard(camera);
    return located;
  }
  if (target.markers && located.pose->second_pose_chi2 < kLeastChi2) {
    located.why = WhyLeanIsUnknown();
    return located;
  }
  located.pose->pose.half_turn_known = known;
  PlaceOutline(target, located.pose->pose.sensor_from_target, &located);
  return located;
}

// Measured where a person picked the board.
Located FromPickedBoard(const Image& image, const cv::Mat& grey, const Camera& camera,
                        const Target& target, const Corners& picks, CameraKind kind) {
  Located located = FromPicks(camera, target, picks);
  if (!located.why.empty()) return located;
  PickedBoardResult found = FindPickedBoard(grey, SaturatedFrom(image), camera, target, picks,
                                            kind == CameraKind::kColor);
  located.why = std::move(found.why);
  if (!found.board) return located;
  located.inner = std::move(found.board->corners);
  located.pose = std::move(found.board->pose);
  PlaceOutline(target, located.pose->pose.sensor_from_target, &located);
  return located;
}

// What goes beyond the paper: pose, its covariance, and each side fitted by itself.
void AddPose(const Image& image, const cv::Mat& grey, const Camera& camera, const Target& target,
             const CornerPose& pose, ImageEdges* edges) {
  edges->pose = pose.pose;
  edges->corner_sigma_px = pose.inflation * pose.corner_sigma_px;
  edges->sides = FitBoardSides(grey, Clipped(image), camera, target, pose.pose);
}

ImageEdgesResult EdgesOf(const Image& image, const cv::Mat& grey, const Camera& camera,
                         const Target& target, const Located& located) {
  if (!located.why.empty()) return {std::nullopt, located.why};
  ImageEdges edges;
  edges.width = image.pixels.cols;
  edges.height = image.pixels.rows;
  edges.corners = located.inner;
  const Gradient gradient = SobelOf(grey);
  std::array<Chain, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = camera.Project(located.outline[i]);
    sides[i] = SideOf(camera, located.outline[i], located.outline[(i + 1) % 4]);
    if (!corner || sides[i].size() < 2) return {std::nullopt, "an outline corner cannot be seen"};
    edges.outline_corners[i] = *corner;
    const Chain fitted = FitSide(sides[i], gradient);
    // Every few pixels is enough: the chain is straight but for the lens.
    for (std::size_t k = 0; k < fitted.size(); k += 8) edges.outline.push_back(fitted[k]);
  }
  edges.edge_pixels = EdgePixelsIn(sides, gradient);
  if (edges.edge_pixels.empty()) {
    return {
        std::nullopt,
        "no edge of the board stands out in the image where its pattern puts it: more contrast is "
        "needed, or square_m, width_m and height_m in the rig file do not go together"};
  }
  if (located.pose) AddPose(image, grey, camera, target, *located.pose, &edges);
  if (located.plain) {
    edges.pose = located.plain->pose;
    edges.corner_sigma_px = located.plain->side_sigma_px;
    edges.sides = located.plain->sides;
  }
  return {edges, ""};
}

ImageEdgesResult Picked(ImageEdgesResult result) {
  if (result.edges) result.edges->picked = true;
  return result;
}

}  // namespace

bool MarkersMayHide(const Target& target, CameraKind kind) {
  return target.holes.has_value() && kind == CameraKind::kThermal;
}

ImageEdgesResult DetectImageEdges(const Image& image, const Camera& camera, const Target& target,
                                  const CornerSelection* picks, CameraKind kind) {
  const cv::Mat grey = ToGrey(image);
  if (!target.HasPattern()) {
    return EdgesOf(image, grey, camera, target, FromPlainBoard(image, grey, camera, target));
  }
  if (picks == nullptr) {
    Located located = FromCheckerboard(image, grey, camera, target, kind);
    if (!located.why.empty() && MarkersMayHide(target, kind)) {
      Located by_outline = FromPlainBoard(image, grey, camera, target);
      if (by_outline.why.empty()) return EdgesOf(image, grey, camera, target, by_outline);
      located.why += "; nor is its outline found: " + by_outline.why;
    }
    return EdgesOf(image, grey, camera, target, located);
  }
  return Picked(EdgesOf(image, grey, camera, target, FromPicks(camera, target, picks->corners)));
}

ImageEdgesResult MeasureWhereOpenCvSees(const Image& image, const Camera& camera,
                                        const Target& target, CameraKind kind) {
  const cv::Mat grey = ToGrey(image);
  constexpr double kLeastSeen = 0.9;  // of the corners: it saw all of them
  ImageEdgesResult result;
  for (const Corners& outline : OutlinesByOpenCv(grey, camera, target)) {
    result.why = "its corners cannot be measured";
    const Located located = FromPickedBoard(image, grey, camera, target, outline, kind);
    const auto seen = std::count_if(located.inner.begin(), located.inner.end(), IsSeen);
    const bool most =
        static_cast<double>(seen) >= kLeastSeen * static_cast<double>(located.inner.size());
    if (!located.why.empty() || !most) continue;
    ImageEdgesResult measured = EdgesOf(image, grey, camera, target, located);
    if (measured.edges) return measured;
  }
  return result;
}

ImageEdgesResult MeasurePickedBoard(const Image& image, const Camera& camera, const Target& target,
                                    const CornerSelection& picks, CameraKind kind) {
  const cv::Mat grey = ToGrey(image);
  return Picked(EdgesOf(image, grey, camera, target,
                        FromPickedBoard(image, grey, camera, target, picks.corners, kind)));
}

}  // namespace rgbdt
