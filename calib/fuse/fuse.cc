#include "calib/fuse/fuse.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/camera/pixels.h"
#include "calib/fuse/radiometry.h"

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// Bilinear sample of an image with `channels` values a pixel; `pixel` lies inside.
template <typename T, int channels>
std::array<double, channels> Sample(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = std::min(static_cast<int>(pixel.x()), image.cols - 2);
  const int y = std::min(static_cast<int>(pixel.y()), image.rows - 2);
  const double fx = pixel.x() - x;
  const double fy = pixel.y() - y;
  const T* top = image.ptr<T>(y) + static_cast<std::ptrdiff_t>(x) * channels;
  const T* bottom = image.ptr<T>(y + 1) + static_cast<std::ptrdiff_t>(x) * channels;
  std::array<double, channels> out;
  for (int c = 0; c < channels; ++c) {
    out[static_cast<std::size_t>(c)] = (1 - fy) * ((1 - fx) * top[c] + fx * top[c + channels]) +
                                       fy * ((1 - fx) * bottom[c] + fx * bottom[c + channels]);
  }
  return out;
}

// Fills what one camera knows of the points of `fused`. `earlier`: bits of the cameras of its kind
// that come before it.
void Colour(const FusionCamera& camera, std::uint32_t bit, std::uint32_t earlier,
            RgbdtCloud* fused) {
  const Eigen::Matrix3d rotation = camera.camera_from_lidar.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < fused->size(); ++i) {
    const PreparedImage* image = camera.ImageAt(fused->utime[i]);
    if (image == nullptr) continue;
    const auto pixel = camera.camera().Project(rotation * fused->points[i].cast<double>() +
                                               camera.camera_from_lidar.translation);
    if (!pixel || !camera.camera().Contains(*pixel)) continue;
    const bool taken = (fused->valid[i] & earlier) != 0;
    fused->valid[i] |= bit;
    if (taken) continue;
    if (camera.spec().kind == CameraKind::kThermal) {
      const double counts = Sample<float, 1>(image->pixels, *pixel)[0];
      fused->thermal_counts[i] = static_cast<float>(counts);
      fused->temperature_k[i] = static_cast<float>(KelvinOf(image->radiometry, counts));
    } else {
      const auto bgr = Sample<std::uint8_t, 3>(image->pixels, *pixel);
      for (std::size_t c = 0; c < 3; ++c) {
        // A black that was seen is 1, 1, 1: 0 says that no colour camera saw the point.
        fused->rgb[i][c] = static_cast<std::uint8_t>(std::max(1L, std::lround(bgr[2 - c])));
      }
    }
  }
}

}  // namespace

PreparedImage Prepare(const CameraSpec& camera, const Image& image) {
  CheckImage(camera, image);
  if (camera.kind == CameraKind::kColor) return {image.utime, ToBgr(image), {}};
  const bool own = image.radiometry.kind != Radiometry::Kind::kNone;
  return {image.utime, ToGrey(image), own ? image.radiometry : camera.radiometry};
}

FusionCamera::FusionCamera(const CameraSpec& spec)
    : spec_(spec), camera_(spec), readout_(FromSeconds(spec.readout_s)) {}

void FusionCamera::AddImage(PreparedImage image) {
  const auto later = std::find_if(images_.begin(), images_.end(), [&](const PreparedImage& other) {
    return other.utime >= image.utime;
  });
  if (later != images_.end() && later->utime == image.utime) return;  // the same image again
  images_.insert(later, std::move(image));
  if (images_.size() > kMaxImages) images_.pop_front();
}

const PreparedImage* FusionCamera::ImageAt(Utime point_utime) const {
  if (images_.empty()) return nullptr;
  if (all_times_) return &images_.back();
  for (auto image = images_.rbegin(); image != images_.rend(); ++image) {
    if (image->utime + readout_ > point_utime) continue;
    return point_utime - image->utime <= kMaxAge ? &*image : nullptr;
  }
  return nullptr;
}

void FusionCamera::ForgetBefore(Utime utime) {
  while (images_.size() > 1 && images_[1].utime + readout_ <= utime) images_.pop_front();
}

RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras) {
  RgbdtCloud fused;
  fused.sweep_utime = cloud.sweep_utime;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    fused.points.push_back(cloud.points[i]);
    fused.intensity.push_back(cloud.intensity.empty() ? kNone : cloud.intensity[i]);
    fused.utime.push_back(cloud.utime.empty() ? cloud.sweep_utime : cloud.utime[i]);
  }
  fused.rgb.assign(fused.size(), {0, 0, 0});
  fused.temperature_k.assign(fused.size(), kNone);
  fused.temperature_sigma_k.assign(fused.size(), kNone);
  fused.thermal_counts.assign(fused.size(), kNone);
  fused.valid.assign(fused.size(), 0);
  std::uint32_t earlier_color = 0;
  std::uint32_t earlier_thermal = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::uint32_t bit = 1U << c;
    fused.cameras.push_back(cameras[c].spec().name);
    const bool thermal = cameras[c].spec().kind == CameraKind::kThermal;
    std::uint32_t& earlier = thermal ? earlier_thermal : earlier_color;
    if (cameras[c].calibrated) Colour(cameras[c], bit, earlier, &fused);
    earlier |= bit;
  }
  return fused;
}

}  // namespace rgbdt
