#pragma once

#include <optional>
#include <string>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// The paper's steps in the cloud. Where it gives no value, lengths are multiples of the point
/// spacing: the median distance from a point on the board to its nearest neighbour on another scan
/// line (line of a turned scanner, ring of a spinning LIDAR). The same for all data.
struct CloudEdgesOptions {
  double corner_window_px = 20;        ///< paper: 20x20 px window of a checkerboard corner
  double ransac_tolerance = 1.0;       ///< distance to the plane [spacings]
  double grow_radius = 2.0;            ///< which points are neighbours [spacings]
  double normal_radius = 4.0;          ///< neighbourhood of a normal [spacings]
  double grow_angle_rad = 0.35;        ///< normal against the seed's
  double mls_radius = 4.0;             ///< Moving Least Squares [spacings]
  double boundary_radius = 3.0;        ///< neighbourhood of boundary estimation [spacings]
  double boundary_angle_rad = 1.5708;  ///< gap between neighbours that makes a boundary (PCL's)
  double hull_alpha = 5.0;             ///< concave hull [spacings]
  double size_tolerance = 0.25;        ///< measured against known size, plus two spacings

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Edges or the reason why there are none.
struct CloudEdgesResult {
  std::optional<CloudEdges> edges;
  std::string why;
};

/// The target's boundary points in a cloud (paper II-A.2, steps a to d). `image_corners` are the
/// checkerboard's inner corners [px]; the guess only has to bring some of the board's points near
/// them. A segment whose size is not the target's is refused with both sizes in the reason.
CloudEdgesResult DetectCloudEdges(const Cloud& cloud, const Camera& camera,
                                  const Rigid3& camera_from_lidar_guess,
                                  const std::vector<Eigen::Vector2d>& image_corners,
                                  const Target& target, const CloudEdgesOptions& options = {});

}  // namespace rgbdt
