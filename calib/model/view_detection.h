#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// A person's picks in one image: the board's four outline corners [px], in order round the board
/// (which one comes first does not matter).
struct CornerSelection {
  std::string camera;
  Utime utime = 0;        ///< when picked, sensors' clock
  Utime image_utime = 0;  ///< the image that they were picked in
  std::int64_t seq = 0;
  std::array<Eigen::Vector2d, 4> corners;
};

/// The target's pose in a sensor's frame: sensor_from_target = Exp(delta) * pose, delta the error
/// (rx, ry, rz [rad], tx, ty, tz [m]) in the sensor's axes.
struct TargetPose {
  Rigid3 sensor_from_target;
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta
  /// False: the target may as well be turned by half a turn about its z.
  bool half_turn_known = false;
};

/// One side of the board in an image, fitted to the image's own gradient.
struct ImageSide {
  bool seen = false;
  std::string why;                     ///< why it is not seen
  std::vector<Eigen::Vector2d> curve;  ///< the fitted side as the lens bends it, end to end [px]
  /// Of the curve's displacement along its normal at its first and last point [px^2].
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

/// Stands for an inner corner that was not seen, in a list that has all of them.
inline Eigen::Vector2d UnseenCorner() {
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}
inline bool IsSeen(const Eigen::Vector2d& corner) { return corner.allFinite(); }

/// What one image shows of the target. Pixels of the distorted image, centres at integers.
struct ImageEdges {
  int width = 0, height = 0;  ///< of the image [px]
  /// Inner corners, all of them in the target's order; NaN where one was not seen (IsSeen): outside
  /// the image, or hidden where `picked`.
  std::vector<Eigen::Vector2d> corners;
  /// Board's corners in order round the board; beginning with the target's top left where there is
  /// a pose.
  std::array<Eigen::Vector2d, 4> outline_corners{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                                 Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  /// A person said where the board is. With a pose: all else was measured from there; without one
  /// (the paper's method): the outline corners are the picks, the inner ones follow from them.
  bool picked = false;
  std::vector<Eigen::Vector2i> edge_pixels;  ///< the target's edge pixels (paper II-A.1)
  /// The fitted outline, closed, as a chain of points through the lens; for `edge_rms_px`.
  std::vector<Eigen::Vector2d> outline;
  double corner_sigma_px = 0;      ///< of a corner along x or y, as if they were independent
  std::optional<TargetPose> pose;  ///< in the camera; from the corners
  std::array<ImageSide, 4> sides;  ///< top, right, bottom, left; without a pose none is seen
};

/// What lies beyond the board where a scan leaves it: it decides how the beam's width moves the
/// board's apparent edge.
enum class CrossingKind {
  kNoReturn = 1,  ///< the beam beyond returned nothing
  kFar = 2,       ///< something so far behind that returns do not merge
  kMerged = 3,    ///< something just behind: the returns of a split beam merge
};

/// Where a scan leaves the board: between the last beam on it and the first beyond.
struct Crossing {
  Eigen::Vector3d point{0, 0, 0};  ///< middle of that interval on the board's plane, LIDAR frame
  double half_width_m = 0;         ///< half of the interval, across the side
  int side = 0;                    ///< 0 top, 1 right, 2 bottom, 3 left of the target
  CrossingKind kind = CrossingKind::kNoReturn;
  /// Of the side's place across it, what its neighbours tell again counted once; 0: unknown.
  double sigma_m = 0;
};

/// Points on the board whose ranges are off alike: one laser's, of about one brightness.
struct PointGroup {
  int ring = -1;              ///< the laser; -1: the cloud does not tell, or there is only one
  double log2_intensity = 0;  ///< mean (Log2Intensity); 0 where the cloud does not tell
  /// As CloudEdges::scatter, of these points, each with its whole weight.
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
};

/// What one cloud shows of the target. LIDAR frame, metres.
struct CloudEdges {
  /// By the paper's method, which looks where a camera's picks and guess say: that camera's. Empty:
  /// every camera's.
  std::string camera;
  std::vector<Eigen::Vector3d> boundary;  ///< the target's boundary points (paper II-A.2)
  Eigen::Vector3d centre{0, 0, 0};        ///< of the segment
  Eigen::Vector3d normal{0, 0, 0};        ///< unit, towards the LIDAR
  double width_m = 0, height_m = 0;       ///< measured extent, width >= height
  double spacing_m = 0;                   ///< point spacing on the board, across lines
  int points = 0;                         ///< in the segment
  /// In the LIDAR frame, from the crossings; absent by the paper's method.
  std::optional<TargetPose> pose;
  std::vector<Crossing> crossings;
  /// All that its points tell of the plane they lie on: the sum over them of q q^T with
  /// q = (p - centre, 1), in metres; p is where the beam meets the fitted plane, moved along the
  /// normal by the point's distance from it, so noise on slanted beams does not lean the plane.
  /// Each point weighs by the noise that its brightness has on this board, one in the mean; where
  /// the points of a ring share an error, what they tell again is taken off.
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  /// The same of the points where they were measured.
  Eigen::Matrix4d raw_scatter = Eigen::Matrix4d::Zero();
  /// Of the distance from the plane of a point of weight one, as if independent of its neighbours;
  /// 0: no scatter is known.
  double scatter_sigma_m = 0;
  /// By bearing-angle alone: the outline's corners, picked among the points, in the order of the
  /// pose's target (Target::OutlineCorners); NaN where none could be picked. Not on the bus.
  std::vector<Eigen::Vector3d> corners;
  /// The same points told apart by what shares an error; empty: by the paper's method. By
  /// line-scan: one group a line, where its points were measured.
  std::vector<PointGroup> groups;
  double group_sigma_m = 0;  ///< as scatter_sigma_m, about the group's mean
  /// How fast a turned scanner's motor turned about the LIDAR's z while it scanned the board
  /// [rad/s]; 0: nothing turned, or the cloud does not tell.
  double turn_rad_s = 0;
};

/// What detection makes of one camera's image in a view.
struct ImageDetection {
  std::string camera;
  Utime utime = 0;  ///< of the image; 0: there is none
  std::optional<ImageEdges> edges;
  /// Why the image cannot be used; empty: it can. Edges may be known all the same, e.g. of a board
  /// that moved.
  std::string why_not;
  double detect_s = 0;  ///< computing time

  bool usable() const { return why_not.empty() && edges.has_value(); }
};

/// What detection makes of a view's cloud.
struct CloudDetection {
  /// All that looks like the target, likeliest first; the views together choose.
  std::vector<CloudEdges> candidates;
  std::string why_not;  ///< why there is none; empty: there is one
  double detect_s = 0;  ///< computing time
};

/// What detection makes of a further LIDAR's cloud, in that LIDAR's own frame.
struct LidarDetection {
  std::string lidar;
  CloudDetection cloud;
};

/// All that one view shows of the target: each camera's image, and the cloud once.
struct ViewDetection {
  std::string view;  ///< its name, e.g. "0001"
  std::int64_t seq = 0;
  Utime sweep_utime = 0;
  bool heldout = false;
  std::vector<ImageDetection> images;  ///< one a camera, in the rig's order
  CloudDetection cloud;                ///< the reference's
  /// One a further LIDAR, in the rig's order. Not on the bus.
  std::vector<LidarDetection> further_clouds{};

  const ImageDetection* Find(const std::string& camera) const {
    for (const ImageDetection& image : images) {
      if (image.camera == camera) return &image;
    }
    return nullptr;
  }
};

/// In words, each sensor apart: "rgb: board found; thermal: no board found ...; cloud: board
/// found".
std::string BriefReport(const ViewDetection& detection);

/// Whether one sensor sees the target now.
struct TargetStatus {
  std::int64_t seq = 0;
  Utime utime = 0;     ///< of the image, or the sweep's start
  std::string camera;  ///< empty: the LIDAR
  bool seen = false;
  std::string text;                      ///< where it is, or why it is not seen
  std::vector<Eigen::Vector2d> corners;  ///< camera: those inner corners that are seen [px]
  std::vector<Eigen::Vector2d> outline;  ///< camera: closed chain through the lens [px]
  Eigen::Vector3d centre{0, 0, 0};       ///< LIDAR: of the board's points, LIDAR frame [m]
};

/// A further LIDAR's cloud, in its own frame.
struct LidarCloud {
  std::string lidar;
  Cloud cloud;
};

/// Everything detection needs for one view.
struct View {
  std::string name;
  bool heldout = false;
  Cloud cloud;                ///< the reference's
  std::vector<Image> images;  ///< one a camera
  std::vector<CornerSelection> picks;
  std::vector<LidarCloud> further_clouds{};  ///< of further LIDARs, those that there are
  /// Where the LIDAR was, in axes common to the session's views; absent: not known.
  std::optional<Rigid3> map_from_lidar{};
};

}  // namespace rgbdt
