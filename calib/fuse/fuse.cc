#include "calib/fuse/fuse.h"

#include <algorithm>

#include "calib/fuse/sweep_fuser.h"

namespace rgbdt {
namespace {

FusionCamera CameraOf(const CameraSpec& spec, const Calibration& calibration, const View& view) {
  FusionCamera camera(spec);
  camera.ServeAllTimes();
  const CameraCalibration* found = calibration.Find(spec.name);
  if (found != nullptr) camera.SetCalibration(*found, calibration.utime);
  const auto image = std::find_if(view.images.begin(), view.images.end(),
                                  [&](const Image& i) { return i.camera == spec.name; });
  if (image != view.images.end()) camera.AddImage(Prepare(spec, *image));
  return camera;
}

}  // namespace

RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras,
                double range_sigma_m) {
  std::vector<CameraSpec> specs;
  specs.reserve(cameras.size());
  for (const FusionCamera& camera : cameras) specs.push_back(camera.spec());
  SweepFuser fuser(specs, range_sigma_m);
  for (std::size_t i = 0; i < cameras.size(); ++i) fuser.camera(i) = cameras[i];
  return fuser.FuseChunk(cloud);
}

RgbdtCloud FuseView(const Rig& rig, const Calibration& calibration, const View& view) {
  std::vector<FusionCamera> cameras;
  for (const CameraSpec& spec : rig.cameras) cameras.push_back(CameraOf(spec, calibration, view));
  RgbdtCloud fused = Fuse(view.cloud, cameras, rig.lidar.range_sigma_m);
  fused.sweep_end = true;
  return fused;
}

}  // namespace rgbdt
