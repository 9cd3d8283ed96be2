#include "calib/fuse/fuse.h"

#include "calib/fuse/sweep_fuser.h"

namespace rgbdt {

RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras,
                double range_sigma_m) {
  std::vector<CameraSpec> specs;
  for (const FusionCamera& camera : cameras) specs.push_back(camera.spec());
  SweepFuser fuser(specs, range_sigma_m);
  for (std::size_t i = 0; i < cameras.size(); ++i) fuser.camera(i) = cameras[i];
  return fuser.FuseChunk(cloud);
}

}  // namespace rgbdt
