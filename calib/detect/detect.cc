#include "calib/detect/detect.h"

#include <algorithm>
#include <chrono>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud_edges.h"
#include "calib/detect/image_edges.h"

namespace rgbdt {
namespace {

// Computing time goes into the report only, never into a result.
class Stopwatch {
 public:
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Observation Empty(const View& view, const std::string& camera) {
  Observation observation;
  observation.view = view.name;
  observation.camera = camera;
  observation.heldout = view.heldout;
  observation.sweep_utime = view.cloud.sweep_utime;
  return observation;
}

}  // namespace

Observation DetectOne(const Rig& rig, const View& view, const Image& image,
                      const CornerSelection* picks) {
  const CameraSpec& spec = rig.Camera(image.camera);
  CheckImage(spec, image);
  const Camera camera(spec);
  Observation observation = Empty(view, image.camera);
  observation.image_utime = image.utime;

  const Stopwatch image_watch;
  ImageEdgesResult in_image = DetectImageEdges(image, camera, rig.target, picks, spec.kind);
  observation.detect_image_s = image_watch.Seconds();
  if (!in_image.edges) {
    observation.rejected = in_image.why;
    return observation;
  }
  observation.image = std::move(in_image.edges);

  if (!spec.camera_from_lidar_guess) {
    observation.rejected =
        "the rig file has no camera_from_lidar_guess for this camera; the "
        "paper's method needs one";
    return observation;
  }
  const int lost = LostLines(view.cloud);
  if (lost * 100 > view.cloud.lines) {  // gaps look like edges
    observation.rejected = std::to_string(lost) + " of the sweep's " +
                           std::to_string(view.cloud.lines) +
                           " lines were lost on the way; look at the assembler's status";
    return observation;
  }
  const Stopwatch cloud_watch;
  CloudEdgesResult in_cloud = DetectCloudEdges(view.cloud, camera, *spec.camera_from_lidar_guess,
                                               observation.image->corners, rig.target);
  observation.detect_cloud_s = cloud_watch.Seconds();
  observation.rejected = in_cloud.why;
  observation.cloud = std::move(in_cloud.edges);
  return observation;
}

std::vector<Observation> DetectView(const Rig& rig, const View& view) {
  std::vector<Observation> observations;
  for (const CameraSpec& camera : rig.cameras) {
    const auto image =
        std::find_if(view.images.begin(), view.images.end(),
                     [&](const Image& candidate) { return candidate.camera == camera.name; });
    if (image == view.images.end()) {
      observations.push_back(Empty(view, camera.name));
      observations.back().rejected = "the view has no image of this camera";
      continue;
    }
    const auto picks =
        std::find_if(view.picks.begin(), view.picks.end(),
                     [&](const CornerSelection& p) { return p.camera == camera.name; });
    observations.push_back(
        DetectOne(rig, view, *image, picks == view.picks.end() ? nullptr : &*picks));
  }
  return observations;
}

}  // namespace rgbdt
