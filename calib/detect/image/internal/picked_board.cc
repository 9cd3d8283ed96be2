#include "calib/detect/image/internal/picked_board.h"

#include <algorithm>
#include <cmath>

#include "calib/detect/image/internal/board_map.h"
#include "calib/detect/image/internal/corner_order.h"
#include "calib/detect/image/internal/grey_image.h"
#include "calib/detect/image/internal/grid_model.h"
#include "calib/detect/image/internal/measured_corners.h"
#include "calib/detect/image/internal/pattern_ends.h"
#include "calib/detect/image/internal/pick_alignment.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Pixels = std::vector<Eigen::Vector2d>;

constexpr double kGridTolerance = 0.2;  // of the distance to the next corner
constexpr double kMostPickPx = 12;      // from a pick to the board's corner
constexpr double kMostOff = 0.4;  // of the corners: what occludes the others reaches into some
constexpr int kRounds = 3;

// Takes out what does not follow a flat grid through a smooth lens.
void DropOffGrid(const Target& target, MeasuredCorners* measured) {
  CornerGrid grid;
  for (std::size_t i = 0; i < measured->fits.size(); ++i) {
    const int index = static_cast<int>(i);
    if (!measured->fits[i]) continue;
    grid[{index % target.corners_x(), index / target.corners_x()}] = measured->fits[i]->place;
  }
  const auto model = GridModel::Fit(grid, kGridTolerance);
  for (auto& [at, place] : grid) {
    if (model && model->Agrees({at, place}, kGridTolerance)) continue;
    measured->fits[static_cast<std::size_t>(at.second * target.corners_x() + at.first)].reset();
  }
}

// Without those beside a corner that was not measured: what occludes that one may reach into what
// was looked at, too faint to be noticed, and pull the place aside.
Pixels FarFromHidden(const Target& target, const MeasuredCorners& measured) {
  const int columns = target.corners_x();
  const auto hidden = [&](int column, int row) {
    const bool inside = column >= 0 && row >= 0 && column < columns && row < target.corners_y();
    return inside && !measured.fits[static_cast<std::size_t>(row * columns + column)];
  };
  Pixels places = measured.places();
  for (int i = 0; i < columns * target.corners_y(); ++i) {
    for (int k = 0; k < 9; ++k) {
      if (!hidden(i % columns + k % 3 - 1, i / columns + k / 3 - 1)) continue;
      places[static_cast<std::size_t>(i)] = UnseenCorner();
    }
  }
  return places;
}

// Takes out what lies off the pose by more than noise does, and a little for an inexact lens.
void DropOffPose(const BoardMap& map, const Target& target, double pose_sigma_px,
                 MeasuredCorners* measured) {
  const double sigma = std::max(measured->sigma_px(), pose_sigma_px);
  const auto corners = target.InnerCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    auto& fit = measured->fits[i];
    if (!fit) continue;
    const auto place = map(corners[i].head<2>());
    const double tolerance =
        std::min(0.05 + 4.5 * sigma + 0.002 * measured->spacings[i], 0.15 * measured->spacings[i]);
    if (!place || (*place - fit->place).norm() > tolerance) fit.reset();
  }
}

std::string WhyNotEnough(const Target& target, const MeasuredCorners& measured) {
  return "of the " + std::to_string(measured.fits.size()) + " inner corners of the " +
         std::to_string(target.squares_x) + "x" + std::to_string(target.squares_y) +
         " squares only " + std::to_string(measured.count()) +
         " could be made out where the board's corners were picked; at least " +
         std::to_string(kLeastCorners) +
         ", in three rows and columns, are needed: pick the board's own four corners, or capture "
         "again with less of the board hidden";
}

// The pose that the corners farthest from what occludes some agree on; without enough of those,
// all.
std::optional<CornerPose> FirstPose(const Camera& camera, const Target& target,
                                    const MeasuredCorners& measured) {
  const Pixels sure = FarFromHidden(target, measured);
  if (Enough(target, sure)) {
    auto pose = PoseFromCorners(camera, target, sure, kMostOff);
    if (pose) return pose;
  }
  return PoseFromCorners(camera, target, measured.places(), kMostOff);
}

// The pose from the corners of `measured`, and these measured again from there.
std::optional<CornerPose> Settle(const cv::Mat& grey, double saturated_from, const Camera& camera,
                                 const Target& target, MeasuredCorners* measured) {
  for (int round = 0; round < kRounds; ++round) {
    const auto pose = FirstPose(camera, target, *measured);
    if (!pose) return std::nullopt;
    const BoardMap map = MapByPose(camera, pose->pose.sensor_from_target);
    *measured = MeasureCorners(grey, saturated_from, target, map, measured->blur_px());
    DropUnlike(measured);
    DropOffPose(map, target, pose->corner_sigma_px, measured);
    if (!Enough(target, *measured)) return std::nullopt;
  }
  return PoseFromCorners(camera, target, measured->places(), kMostOff);
}

// How uncertain a place on the board is in the image [px], along its worst direction.
double SigmaAt(const Camera& camera, const TargetPose& pose, const Eigen::Vector3d& on_board) {
  const Eigen::Vector3d p = pose.sensor_from_target * on_board;
  const Eigen::Matrix3d covariance = PointCovariance(pose.covariance, p);
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step =
        std::sqrt(std::max(0.0, covariance(axis, axis))) * Eigen::Vector3d::Unit(axis);
    const auto from = camera.Project(p);
    const auto to = camera.Project(p + step);
    if (from && to) worst = std::max(worst, (*to - *from).norm());
  }
  return worst;
}

std::string WhyNotPicked(const Camera& camera, const Target& target, const AlignedPicks& aligned,
                         const TargetPose& pose) {
  const auto outline = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.Project(pose.sensor_from_target * outline[i]);
    const double off = pixel ? (*pixel - aligned.picks[i]).norm() : 1e9;
    if (off < kMostPickPx + 3 * SigmaAt(camera, pose, outline[i])) continue;
    return "a picked corner is " + (pixel ? std::to_string(std::lround(off)) + " px" : "far") +
           " from where the checkerboard has the board's corner; pick the board's own four corners";
  }
  return "";
}

// In the target's order, as far as the pattern tells.
PickedBoardResult InOrder(const cv::Mat& grey, const Camera& camera, const Target& target,
                          Pixels corners, bool black_is_dark) {
  const bool known = OrderCorners(grey, target, black_is_dark, &corners);
  const auto pose = PoseFromCorners(camera, target, corners, kMostOff);
  if (!pose) return {std::nullopt, "the corners that were made out do not fit a flat board"};
  PickedBoard board{std::move(corners), *pose};
  for (std::size_t i = 0; i < board.corners.size(); ++i) {
    if (!pose->used[i]) board.corners[i] = UnseenCorner();  // measured, but not a corner
  }
  board.pose.pose.half_turn_known = known;
  return {std::move(board), ""};
}

}  // namespace

PickedBoardResult FindPickedBoard(const cv::Mat& grey, double saturated_from, const Camera& camera,
                                  const Target& target, const std::array<Eigen::Vector2d, 4>& picks,
                                  bool black_is_dark) {
  const cv::Mat repaired = RepairDeadPixels(grey);
  MeasuredCorners measured;
  measured.fits.resize(target.InnerCorners().size());
  const auto aligned = AlignPicks(repaired, camera, target, picks);
  const auto map = aligned ? MapByOutline(camera, target, aligned->outline) : std::nullopt;
  if (!map) return {std::nullopt, WhyNotEnough(target, measured)};
  measured = MeasureCorners(repaired, saturated_from, target, *map, std::nullopt);
  DropUnlike(&measured);
  DropOffGrid(target, &measured);
  if (!Enough(target, measured)) return {std::nullopt, WhyNotEnough(target, measured)};
  const auto pose = Settle(repaired, saturated_from, camera, target, &measured);
  if (!Enough(target, measured)) return {std::nullopt, WhyNotEnough(target, measured)};
  if (!pose) return {std::nullopt, WhyNoFlatBoard(camera)};
  if (pose->second_pose_chi2 < kLeastChi2) {
    return {std::nullopt, WhyLeanIsUnknown()};
  }
  std::string why =
      WhyPatternMayBeShifted(repaired, MapByPose(camera, pose->pose.sensor_from_target), target,
                             measured.places(), measured.contrast());
  if (why.empty()) why = WhyNotPicked(camera, target, *aligned, pose->pose);
  if (!why.empty()) return {std::nullopt, why};
  return InOrder(grey, camera, target, measured.places(), black_is_dark);
}

Pixels CornersNear(const cv::Mat& grey, double saturated_from, const Camera& camera,
                   const Target& target, const Rigid3& camera_from_target) {
  MeasuredCorners measured = MeasureCorners(RepairDeadPixels(grey), saturated_from, target,
                                            MapByPose(camera, camera_from_target), std::nullopt);
  DropUnlike(&measured);
  return measured.places();
}

}  // namespace rgbdt
