#include "calib/fuse/fusion_camera.h"

#include <algorithm>
#include <utility>

#include "calib/camera/pixels.h"

namespace rgbdt {

PreparedImage Prepare(const CameraSpec& camera, const Image& image) {
  CheckImage(camera, image);
  if (camera.kind == CameraKind::kColor) return {image.utime, ToBgr(image), {}};
  const bool own = image.radiometry.kind != Radiometry::Kind::kNone;
  return {image.utime, ToGrey(image), own ? image.radiometry : camera.radiometry};
}

FusionCamera::FusionCamera(const CameraSpec& spec)
    : spec_(spec),
      given_(spec.lens),
      given_rolling_s_(spec.rolling_s),
      camera_(spec),
      readout_(FromSeconds(spec.readout_s)) {}

bool FusionCamera::Has(const CameraCalibration& calibration, Utime utime) const {
  const Rigid3& pose = calibration.camera_from_lidar;
  return calibrated && calibration_utime == utime &&
         camera_from_lidar.translation == pose.translation &&
         camera_from_lidar.rotation.coeffs() == pose.rotation.coeffs() &&
         spec_.lens == (calibration.lens ? calibration.lens->lens : given_) &&
         range_errors == calibration.range_errors && timing_ == calibration.timing;
}

void FusionCamera::SetCalibration(const CameraCalibration& calibration, Utime utime) {
  calibrated = true;
  camera_from_lidar = calibration.camera_from_lidar;
  calibration_utime = utime;
  range_errors = calibration.range_errors;
  spec_.lens = calibration.lens ? calibration.lens->lens : given_;
  timing_ = calibration.timing;
  offset_ = timing_ ? timing_->Offset() : 0;
  spec_.rolling_s = timing_ ? timing_->rolling_s.value : given_rolling_s_;
  camera_ = Camera(spec_);
}

// Takes away the one whose neighbours lie closest together in time.
void FusionCamera::Thin() {
  auto least = images_.begin() + 1;
  for (auto one = least; one + 1 != images_.end(); ++one) {
    const auto gap = [](auto place) { return (place + 1)->utime - (place - 1)->utime; };
    if (gap(one) < gap(least)) least = one;
  }
  images_.erase(least);
}

void FusionCamera::AddImage(PreparedImage image, Full full) {
  const auto later = std::find_if(images_.begin(), images_.end(), [&](const PreparedImage& other) {
    return other.utime >= image.utime;
  });
  if (later != images_.end() && later->utime == image.utime) return;  // the same image again
  if (spec_.kind == CameraKind::kThermal) {
    if (temperatures_ == nullptr || !temperatures_->IsFor(image.radiometry)) {
      temperatures_ = std::make_shared<TemperatureTable>(image.radiometry, spec_.netd_k);
    }
    image.temperatures = temperatures_;
  }
  images_.insert(later, std::move(image));
  if (images_.size() <= kMaxImages) return;
  if (full == Full::kThin) {
    Thin();
  } else {
    images_.pop_front();
  }
}

Utime FusionCamera::ServesFrom(const PreparedImage& image) const {
  return image.utime + std::max<Utime>(0, offset_) + readout_;
}

Serving FusionCamera::ServingAt(Utime point_utime) const {
  Serving serving;
  if (images_.empty()) return serving;
  if (all_times_) {
    serving.image = &images_.back();
    return serving;
  }
  for (auto image = images_.rbegin(); image != images_.rend(); ++image) {
    const Utime from = ServesFrom(*image);
    if (from > point_utime) {
      serving.until = from;
      continue;
    }
    const Utime end = TakenAt(*image) + kMaxAge;
    if (point_utime <= end) {
      serving.image = &*image;
      serving.from = from;
      serving.until = std::min(serving.until, end + 1);
    } else {
      serving.from = end + 1;
    }
    break;
  }
  return serving;
}

void FusionCamera::ForgetBefore(Utime utime) {
  while (images_.size() > 1 && ServesFrom(images_[1]) <= utime) images_.pop_front();
}

}  // namespace rgbdt
