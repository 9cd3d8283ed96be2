#include "calib/solve/camera_views.h"

#include <algorithm>
#include <tuple>

namespace rgbdt {
namespace {

// Why an observation cannot be used; empty: it can. What comes from the bus may be well formed and
// still hold nothing to solve with.
std::string WhyUnusable(const CameraSpec& camera, const Observation& o) {
  if (!o.rejected.empty()) return o.rejected;
  if (!o.image || o.image->edge_pixels.empty() || o.image->outline.empty()) {
    return "the observation has no edges in the image";
  }
  if (!o.cloud || o.cloud->boundary.empty()) {
    return "the observation has no boundary points in the cloud";
  }
  if (o.image->width != camera.width || o.image->height != camera.height) {
    return "the observation's image is " + std::to_string(o.image->width) + "x" +
           std::to_string(o.image->height) + ", the rig file says " + std::to_string(camera.width) +
           "x" + std::to_string(camera.height);
  }
  return "";
}

}  // namespace

std::vector<const Observation*> CameraViews::Usable() const {
  std::vector<const Observation*> usable;
  for (const Observation& o : all) {
    if (WhyUnusable(*spec, o).empty()) usable.push_back(&o);
  }
  return usable;
}

std::vector<const Observation*> CameraViews::Used() const {
  std::vector<const Observation*> used = Usable();
  used.erase(std::remove_if(used.begin(), used.end(), [](auto* o) { return o->heldout; }),
             used.end());
  return used;
}

const Observation* CameraViews::Find(const std::string& view) const {
  for (const Observation* o : Used()) {
    if (o->view == view) return o;
  }
  return nullptr;
}

void CameraViews::Describe() {
  for (const Observation& o : all) {
    report.detect_image_s += o.detect_image_s;
    report.detect_cloud_s += o.detect_cloud_s;
    const std::string why = WhyUnusable(*spec, o);
    if (!why.empty()) {
      report.rejected.push_back({o.view, why});
    } else {
      (o.heldout ? report.heldout : report.used).push_back(o.view);
    }
  }
}

CameraViews ViewsOf(const CameraSpec& camera, const std::vector<Observation>& observations) {
  CameraViews views;
  views.spec = &camera;
  views.report.calibration.camera = camera.name;
  for (const Observation& o : observations) {
    if (o.camera == camera.name) views.all.push_back(o);
  }
  std::stable_sort(
      views.all.begin(), views.all.end(), [](const Observation& a, const Observation& b) {
        return std::tie(a.view, a.image_utime, a.seq) < std::tie(b.view, b.image_utime, b.seq);
      });
  return views;
}

}  // namespace rgbdt
