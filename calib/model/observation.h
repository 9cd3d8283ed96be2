#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/image.h"

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

/// What one image shows of the target. Pixels of the distorted image, centres at integers.
struct ImageEdges {
  int width = 0, height = 0;             ///< of the image [px]
  std::vector<Eigen::Vector2d> corners;  ///< inner corners, the target's order
  /// Board's corners in order round the board; beginning with the target's top left if not picked.
  std::array<Eigen::Vector2d, 4> outline_corners;
  bool picked = false;                       ///< outline corners come from a person
  std::vector<Eigen::Vector2i> edge_pixels;  ///< the target's edge pixels (paper II-A.1)
  /// The fitted outline, closed, as a chain of points through the lens; for `edge_rms_px`.
  std::vector<Eigen::Vector2d> outline;
};

/// What one cloud shows of the target. LIDAR frame, metres.
struct CloudEdges {
  std::vector<Eigen::Vector3d> boundary;  ///< the target's boundary points (paper II-A.2)
  Eigen::Vector3d centre{0, 0, 0};        ///< of the segment
  Eigen::Vector3d normal{0, 0, 0};        ///< unit, towards the LIDAR
  double width_m = 0, height_m = 0;       ///< measured extent, width >= height
  double spacing_m = 0;                   ///< point spacing on the board, across lines
  int points = 0;                         ///< in the segment
};

/// One camera's view of the target together with the cloud's. Either both edges or a reason.
struct Observation {
  std::string view;  ///< name of the view, e.g. "0001"
  std::string camera;
  std::int64_t seq = 0;
  Utime sweep_utime = 0;
  Utime image_utime = 0;
  bool heldout = false;
  std::optional<ImageEdges> image;
  std::optional<CloudEdges> cloud;
  std::string rejected;       ///< why it cannot be used; empty: it can
  double detect_image_s = 0;  ///< computing time
  double detect_cloud_s = 0;

  bool usable() const { return rejected.empty() && image && cloud; }
};

/// Everything detection needs for one view.
struct View {
  std::string name;
  bool heldout = false;
  Cloud cloud;
  std::vector<Image> images;  ///< one a camera
  std::vector<CornerSelection> picks;
};

}  // namespace rgbdt
