#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// What is kept of a view so that a browser can look at it later: its images as frames, and points
/// of its cloud.
struct KeptView {
  static constexpr std::size_t kPoints = 100'000;

  std::string name;
  std::map<std::string, Utime> images;                                 ///< by camera
  std::map<std::string, std::shared_ptr<const std::string>> pictures;  ///< ImageFrames, by camera
  std::map<std::string, std::shared_ptr<const std::string>> thumbs;    ///< ThumbFrames, by camera
  std::shared_ptr<const Cloud> cloud;  ///< points that returned, and their intensity
};

/// Encodes the images; some 50 ms a view.
KeptView KeepView(const View& view);

/// A view's small pictures, for everybody.
std::vector<Post> ThumbPosts(const KeptView& view);

/// The board in the cloud; made when the first browser gets it. Nothing where it was not found.
std::optional<Post> BoardPost(const KeptView& view, const std::optional<CloudEdges>& board);

/// A camera's image in the view, and what is to be drawn on it. `detection` and
/// `camera_from_lidar` may be empty.
std::vector<Post> PicturePosts(const KeptView& view, const CameraSpec& camera,
                               const std::optional<ViewDetection>& detection,
                               const std::optional<Rigid3>& camera_from_lidar);

}  // namespace rgbdt::viewer
