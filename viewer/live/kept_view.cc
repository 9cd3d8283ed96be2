#include "viewer/live/kept_view.h"

#include <cmath>

#include "calib/present/frames/image_frame.h"
#include "calib/present/frames/overlay_frame.h"

namespace rgbdt::viewer {
namespace {

constexpr int kPictureWidth = 2000;  // [px]: corners are picked in it
constexpr int kPictureQuality = 90;
constexpr const char* kNotYet = "not looked at yet";

using SharedBytes = std::shared_ptr<const std::string>;

SharedBytes Shared(std::string bytes) {
  return std::make_shared<const std::string>(std::move(bytes));
}

Post Ready(const std::string& topic, SharedBytes bytes, bool kept) {
  Post post;
  post.topic = topic;
  post.kept = kept;
  post.make = [bytes = std::move(bytes)] { return *bytes; };
  return post;
}

}  // namespace

KeptView KeepView(const View& view) {
  KeptView kept;
  kept.name = view.name;
  ImageFrameOptions options;
  options.max_width = kPictureWidth;
  options.quality = kPictureQuality;
  for (const Image& image : view.images) {
    // Others of a camera were taken while the scanner turned.
    if (!kept.images.emplace(image.camera, image.utime).second) continue;
    kept.pictures[image.camera] = Shared(ImageFrame(image, view.name, false, options));
    kept.thumbs[image.camera] = Shared(ThumbFrame(image, view.name));
  }
  kept.cloud = std::make_shared<const Cloud>(SomePoints(view.cloud, KeptView::kPoints));
  return kept;
}

std::vector<Post> ThumbPosts(const KeptView& view) {
  std::vector<Post> posts;
  for (const auto& [camera, bytes] : view.thumbs) {
    posts.push_back(Ready("thumb/" + view.name + "/" + camera, bytes, true));
  }
  return posts;
}

std::optional<Post> BoardPost(const KeptView& view, const std::optional<CloudEdges>& board) {
  if (!board || view.cloud == nullptr) return std::nullopt;
  Post post;
  post.topic = "thumb/" + view.name + "/";
  post.make = [name = view.name, board = *board, cloud = view.cloud] {
    return BoardThumbFrame(name, board, *cloud);
  };
  return post;
}

std::vector<Post> PicturePosts(const KeptView& view, const CameraSpec& camera,
                               const std::optional<ViewDetection>& detection,
                               const std::optional<Rigid3>& camera_from_lidar) {
  const auto picture = view.pictures.find(camera.name);
  if (picture == view.pictures.end()) return {};
  std::vector<Post> posts;
  posts.push_back(Ready("view/" + view.name + "/" + camera.name, picture->second, false));
  ViewDetection seen;
  seen.view = view.name;
  seen.images.push_back({camera.name, 0, std::nullopt, kNotYet, 0});
  seen.cloud.why_not = kNotYet;
  if (detection) seen = *detection;
  Post overlay;
  overlay.topic = "overlay/" + view.name + "/" + camera.name;
  overlay.kept = false;
  overlay.make = [camera, seen, cloud = view.cloud, camera_from_lidar] {
    return OverlayFrame(ViewOverlay(camera, seen, cloud.get(), camera_from_lidar), false);
  };
  posts.push_back(std::move(overlay));
  return posts;
}

}  // namespace rgbdt::viewer
