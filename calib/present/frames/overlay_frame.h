#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What is to be drawn on one image.
struct Overlay {
  std::string camera;
  std::string view;  ///< empty: the newest, live
  Utime utime = 0;   ///< of the image
  bool calibrated = false;
  std::string text;
  std::vector<Eigen::Vector2d> corners;  ///< [px]
  std::vector<Eigen::Vector2d> outline;  ///< closed chain [px]
  std::vector<Eigen::Vector3d> edge;     ///< x, y, distance from the outline [px]
  std::vector<Eigen::Vector3d> cloud;    ///< x, y [px], distance from the camera [m]
};

/// Lays points of the LIDAR frame on a camera's image: x, y [px], distance from the camera [m].
/// Those that it does not see are left out. At most `most`, in an order of which any first part is
/// an even sample.
std::vector<Eigen::Vector3d> LayOnImage(const CameraSpec& spec, const Rigid3& camera_from_lidar,
                                        const std::vector<Eigen::Vector3f>& points,
                                        std::size_t most = 20000);

/// Some of the points that returned, `most` or a few more, evenly chosen, with their intensity: to
/// be kept for overlays. It is no longer organised.
Cloud SomePoints(const Cloud& cloud, std::size_t most);

/// A view's overlay: what detection found in the image and, with a calibration, the board's edge in
/// the cloud and the cloud itself, both laid on the image. `camera`: with the lens
/// that belongs to the pose. `cloud` may be null.
Overlay ViewOverlay(const CameraSpec& camera, const ViewDetection& detection, const Cloud* cloud,
                    const std::optional<Rigid3>& camera_from_lidar);

/// As an OverlayFrame.
std::string OverlayFrame(const Overlay& overlay, bool ack);

/// A ThumbFrame of the board in the cloud, seen along its normal from the LIDAR's side: its points
/// by intensity, what lies round it dimmer, crossings as marks.
std::string BoardThumbFrame(const std::string& view, const CloudEdges& board, const Cloud& cloud);

}  // namespace rgbdt
