#include "calib/detect/image/stillness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

#include "calib/camera/pixels.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/internal/picked_board.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr std::size_t kLeastCorners = 8;  // to tell a pose

using Pixels = std::vector<Eigen::Vector2d>;
using Points = std::vector<cv::Point2f>;

// Of the corners that are seen.
Points ToPoints(const Pixels& pixels) {
  Points points;
  for (const Eigen::Vector2d& p : pixels) {
    if (IsSeen(p)) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return points;
}

// The points in place of the corners that are seen in `like`.
Pixels ToPixels(const Points& points, const Pixels& like) {
  Pixels pixels = like;
  auto point = points.begin();
  for (Eigen::Vector2d& p : pixels) {
    if (!IsSeen(p)) continue;
    p = {point->x, point->y};
    ++point;
  }
  return pixels;
}

std::size_t CountSeen(const Pixels& corners) {
  return static_cast<std::size_t>(std::count_if(corners.begin(), corners.end(), IsSeen));
}

// Share of the corners that may be off the rest: what occludes a part of the board reaches into the
// windows of the corners beside it.
double MostOff(const Pixels& corners) { return CountSeen(corners) < corners.size() ? 0.4 : 0.2; }

// Half a window well inside the four squares that meet in a corner.
int HalfWindow(const Target& target, const Pixels& corners) {
  const auto columns = static_cast<std::size_t>(target.corners_x());
  double shortest = 1e9;
  const auto look_at = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    if (IsSeen(a) && IsSeen(b)) shortest = std::min(shortest, (a - b).norm());
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if ((i + 1) % columns != 0) look_at(corners[i + 1], corners[i]);
    if (i + columns < corners.size()) look_at(corners[i + columns], corners[i]);
  }
  if (target.holes) {  // no farther than the marker's border is wide
    const int cells = FindMarkerFamily(target.markers->family)->cells;
    return std::clamp(static_cast<int>(shortest / (cells + 2)), 2, 11);
  }
  // Of ChArUco also beside the markers in two of them.
  const bool inside = target.markers && !target.markers->grid();
  const double share = inside ? 0.5 * (1 - target.markers->side_m / target.square_m) : 0.35;
  return std::clamp(static_cast<int>(share * shortest), 2, 11);
}

// The same refinement in both images, whatever found the corners: their difference is what counts.
Pixels RefineCorners(const cv::Mat& grey, const Pixels& corners, int half) {
  Points points = ToPoints(corners);
  cv::cornerSubPix(grey, points, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
  return ToPixels(points, corners);
}

// Lucas and Kanade's tracker there and back; nothing where less than four fifths return.
std::optional<Pixels> Track(const cv::Mat& from, const cv::Mat& to, const Pixels& corners) {
  const Points start = ToPoints(corners);
  Points there;
  Points back;
  std::vector<std::uint8_t> found;
  std::vector<std::uint8_t> returned;
  std::vector<float> errors;
  const cv::Size window(21, 21);
  cv::calcOpticalFlowPyrLK(from, to, start, there, found, errors, window, 4);
  cv::calcOpticalFlowPyrLK(to, from, there, back, returned, errors, window, 4);
  std::size_t good = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    good += found[i] != 0 && returned[i] != 0 && cv::norm(back[i] - start[i]) < 1 ? 1U : 0U;
  }
  if (5 * good < 4 * start.size()) return std::nullopt;
  return ToPixels(there, corners);
}

// A board seen twice does not lie about where its corners are much more the second time.
bool FitsAsWell(const std::optional<CornerPose>& pose, const CornerPose& at_capture) {
  return pose && pose->corner_sigma_px < 3 * at_capture.corner_sigma_px + 0.1;
}

struct Sight {
  const Camera* camera;
  const Target* target;
  int half_window;
  cv::Mat grey;
  cv::Mat stretched;  // CV_8U, at capture
  CornerPose pose;    // at capture
  Pixels corners;     // at capture; NaN: not seen
};

bool InImage(const Camera& camera, const Pixels& corners) {
  return std::all_of(corners.begin(), corners.end(),
                     [&](const Eigen::Vector2d& c) { return !IsSeen(c) || camera.Contains(c); });
}

// Of two orders of the same corners, half a turn apart, the one nearer to the first sight.
Pixels NearerOrder(const Pixels& found, const Pixels& before) {
  Pixels turned(found.rbegin(), found.rend());
  double straight = 0;
  double reversed = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!IsSeen(before[i]) || !IsSeen(found[i]) || !IsSeen(turned[i])) continue;
    straight += (found[i] - before[i]).norm();
    reversed += (turned[i] - before[i]).norm();
  }
  return reversed < straight ? turned : found;
}

// The pattern's outermost squares along one of its sides: their centres (of ChArUco: the middle of
// what is beyond the markers), target frame, and which inner corner lies between each and the next.
struct OuterSide {
  std::vector<Eigen::Vector3d> squares;
  std::vector<std::size_t> corners;
};

std::array<OuterSide, 4> OuterSquares(const Target& target) {
  const Eigen::Vector2d first = target.pattern_offset_m - 0.5 * target.PatternSize();
  const bool markers_inside = target.markers && !target.markers->grid();
  const double out = markers_inside ? 0.25 * (target.square_m + target.markers->side_m) : 0;
  const auto outwards = [&](int index, int squares) {
    return index == 0 ? -out : index == squares - 1 ? out : 0;
  };
  const auto at = [&](int column, int row) {
    const double x = 0.5 * (target.ColumnEdge(column) + target.ColumnEdge(column + 1));
    const double y = 0.5 * (target.RowEdge(row) + target.RowEdge(row + 1));
    return Eigen::Vector3d(first.x() + x + outwards(column, target.squares_x),
                           first.y() + y + outwards(row, target.squares_y), 0);
  };
  const auto corner = [&](int column, int row) {
    return static_cast<std::size_t>(row * target.corners_x() + column);
  };
  std::array<OuterSide, 4> sides;
  for (int column = 0; column < target.squares_x; ++column) {
    sides[0].squares.push_back(at(column, 0));
    sides[1].squares.push_back(at(column, target.squares_y - 1));
  }
  for (int column = 0; column < target.corners_x(); ++column) {
    sides[0].corners.push_back(corner(column, 0));
    sides[1].corners.push_back(corner(column, target.corners_y() - 1));
  }
  for (int row = 0; row < target.squares_y; ++row) {
    sides[2].squares.push_back(at(0, row));
    sides[3].squares.push_back(at(target.squares_x - 1, row));
  }
  for (int row = 0; row < target.corners_y(); ++row) {
    sides[2].corners.push_back(corner(0, row));
    sides[3].corners.push_back(corner(target.corners_x() - 1, row));
  }
  return sides;
}

// Mean of 3 x 3 pixels.
std::optional<double> Brightness(const Camera& camera, const cv::Mat& grey,
                                 const Eigen::Vector3d& point_in_camera) {
  const auto pixel = camera.Project(point_in_camera);
  if (!pixel) return std::nullopt;
  const cv::Rect around(static_cast<int>(std::lround(pixel->x())) - 1,
                        static_cast<int>(std::lround(pixel->y())) - 1, 3, 3);
  if ((around & cv::Rect(0, 0, grey.cols, grey.rows)) != around) return std::nullopt;
  return cv::mean(grey(around))[0];
}

// A pattern is like itself two squares farther on, and a tracker may take one for the other; but
// then its outermost squares are not there. In three of four pairs of neighbours along each side
// the difference in brightness is to be what it was, in sign and at least a third of it in size.
// Pairs beside a corner that was not seen, then or now, say nothing. Markers that stand alone are
// like no others.
bool OuterSquaresAreThere(const Sight& sight, const cv::Mat& grey, const Rigid3& pose,
                          const Pixels& corners) {
  if (sight.target->holes) return true;
  for (const OuterSide& side : OuterSquares(*sight.target)) {
    std::size_t alike = 0;
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < side.corners.size(); ++i) {
      const std::size_t corner = side.corners[i];
      if (!IsSeen(sight.corners[corner]) || !IsSeen(corners[corner])) continue;
      ++pairs;
      const Rigid3& before = sight.pose.pose.sensor_from_target;
      const auto a = Brightness(*sight.camera, sight.grey, before * side.squares[i]);
      const auto b = Brightness(*sight.camera, sight.grey, before * side.squares[i + 1]);
      const auto c = Brightness(*sight.camera, grey, pose * side.squares[i]);
      const auto d = Brightness(*sight.camera, grey, pose * side.squares[i + 1]);
      if (!a || !b || !c || !d) continue;
      alike += (*c - *d) * (*a - *b) > (*a - *b) * (*a - *b) / 3 ? 1U : 0U;
    }
    if (4 * alike < 3 * pairs) return false;
  }
  return true;
}

// The pose in another image: by tracking, or, where the board went too far for that, found anew.
std::optional<CornerPose> PoseIn(const Sight& sight, const cv::Mat& grey) {
  const auto fitted = [&](const Pixels& corners) -> std::optional<CornerPose> {
    if (CountSeen(corners) < kLeastCorners) return std::nullopt;
    if (!InImage(*sight.camera, corners)) return std::nullopt;
    auto pose = PoseFromCorners(*sight.camera, *sight.target,
                                RefineCorners(grey, corners, sight.half_window), MostOff(corners));
    if (!FitsAsWell(pose, sight.pose)) return std::nullopt;
    if (!OuterSquaresAreThere(sight, grey, pose->pose.sensor_from_target, corners)) {
      return std::nullopt;
    }
    return pose;
  };
  const auto tracked = Track(sight.stretched, Stretch(grey), sight.corners);
  if (tracked) {
    auto pose = fitted(*tracked);
    if (pose) return pose;
  }
  const bool partly_hidden = CountSeen(sight.corners) < sight.corners.size();
  if (partly_hidden) {  // what occludes it may have moved on
    auto pose = fitted(CornersNear(grey, kNeverSaturated, *sight.camera, *sight.target,
                                   sight.pose.pose.sensor_from_target));
    if (pose) return pose;
  }
  const auto found = FindCheckerboard(grey, *sight.target).board;
  if (!found) return std::nullopt;
  return fitted(found->order_known ? found->corners : NearerOrder(found->corners, sight.corners));
}

// Median distance [px] between where two poses put the corners that were seen.
double MedianShift(const Sight& sight, const Rigid3& later) {
  std::vector<double> shifts;
  const auto points = sight.target->InnerCorners();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!IsSeen(sight.corners[i])) continue;
    const Eigen::Vector3d& point = points[i];
    const auto a = sight.camera->Project(sight.pose.pose.sensor_from_target * point);
    const auto b = sight.camera->Project(later * point);
    if (a && b) shifts.push_back((*a - *b).norm());
  }
  return Median(std::move(shifts));
}

// How far the board's centre went [m]. Along the line of sight an image tells little: that part
// counts only where it is beyond 3 sigma.
double CentreShift(const TargetPose& before, const TargetPose& after) {
  const Eigen::Vector3d shift =
      after.sensor_from_target.translation - before.sensor_from_target.translation;
  const Eigen::Vector3d sight = before.sensor_from_target.translation.normalized();
  const double along = shift.dot(sight);
  const double across = (shift - along * sight).norm();
  const Eigen::Matrix3d covariance =
      PointCovariance(before.covariance, before.sensor_from_target.translation) +
      PointCovariance(after.covariance, after.sensor_from_target.translation);
  const double sigma = std::sqrt(sight.dot(covariance * sight));
  return std::abs(along) > 3 * sigma ? std::hypot(along, across) : across;
}

}  // namespace

std::string WhyNotStill(const Camera& camera, const Target& target, const cv::Mat& grey_at_capture,
                        const std::vector<Eigen::Vector2d>& corners,
                        const std::vector<SweepImage>& others) {
  if (others.empty()) return "";
  Sight sight;
  sight.camera = &camera;
  sight.target = &target;
  sight.half_window = HalfWindow(target, corners);
  sight.grey = grey_at_capture;
  sight.stretched = Stretch(grey_at_capture);
  sight.corners = RefineCorners(grey_at_capture, corners, sight.half_window);
  const bool partly_hidden = CountSeen(corners) < corners.size();
  const auto pose = PoseFromCorners(camera, target, sight.corners, MostOff(corners));
  if (!pose)
    return "whether the board stood still is not known: its corners do not fit a flat board";
  sight.pose = *pose;
  for (std::size_t i = 0; partly_hidden && i < corners.size(); ++i) {
    if (!pose->used[i]) sight.corners[i] = UnseenCorner();
  }
  for (const SweepImage& other : others) {
    const auto later = PoseIn(sight, other.grey);
    if (!later) {
      return "board moved: not found again in the image " +
             Format("%.1f s after the sweep's start", other.after_start_s);
    }
    const double shift_px = MedianShift(sight, later->pose.sensor_from_target);
    if (shift_px <= kStillPx) continue;
    return "board moved " + Format("%.0f", 1000 * CentreShift(sight.pose.pose, later->pose)) +
           " mm during the sweep (" + Format("%.1f", shift_px) + " px in the image " +
           Format("%.1f s after its start)", other.after_start_s);
  }
  return "";
}

}  // namespace rgbdt
