#include "services/drivers/camera/camera_node.h"

#include <cstdio>
#include <utility>

#include "calib/camera/packed.h"
#include "calib/camera/pixels.h"
#include "calib/files/image_files.h"
#include "calib/files/keep_aside.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/drivers/camera/internal/frame_format.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

constexpr int kWaitMs = 50;
constexpr Utime kAskEvery = kMicrosecondsPerSecond;

const CameraSpec& TheOnlyOneWithDevice(const Rig& rig) {
  const CameraSpec* found = nullptr;
  for (const CameraSpec& camera : rig.cameras) {
    if (!camera.device) continue;
    if (found != nullptr) {
      throw InputError("the rig has more than one camera with a device; which? --camera " +
                       found->name + " or --camera " + camera.name);
    }
    found = &camera;
  }
  if (found == nullptr) {
    throw InputError(
        "no camera in the rig file has device { ... }; scripts/rigs/README.md has examples");
  }
  return *found;
}

const CameraSpec& WithDevice(const Rig& rig, const std::string& camera) {
  if (camera.empty()) return TheOnlyOneWithDevice(rig);
  const CameraSpec& spec = rig.Camera(camera);
  if (spec.device) return spec;
  throw InputError("the rig file says nothing of how to reach camera \"" + spec.name +
                   "\"; add device { serial: \"...\" } or device { address: \"...\" } to it");
}

std::string Seconds(Utime duration) { return Format("%.1f s", ToSeconds(duration)); }

}  // namespace

CameraDevice::Wire WireOf(const CameraSpec& camera, bool leaves_machine) {
  using Wire = CameraDevice::Wire;
  if (camera.device && camera.device->wire) return *camera.device->wire;
  if (!leaves_machine) return Wire::kRaw;
  return camera.kind == CameraKind::kThermal ? Wire::kPng : Wire::kJpeg;
}

CameraNode::CameraNode(const Rig& rig, const std::string& camera, std::filesystem::path captures,
                       bool leaves_machine)
    : spec_(WithDevice(rig, camera)),
      captures_(std::move(captures)),
      wire_(WireOf(spec_, leaves_machine)),
      thread_([this](DeviceThread& thread) { Serve(thread); }, kMaxWaiting) {}

Messages CameraNode::Handle(const Message& message) {
  const auto* command = std::get_if<SessionCommand>(&message);
  if (command == nullptr || command->verb != SessionVerb::kCapture) return {};
  const std::lock_guard<std::mutex> lock(mutex_);
  capture_ = Capture{command->view, command->utime};
  trigger_ = spec_.device->trigger == CameraDevice::Trigger::kSoftware;
  return {};
}

void CameraNode::WarnOf(const std::string& what, DeviceThread& thread) const {
  thread.Warn(spec_.name + ": " + what);
}

CameraNode::~CameraNode() {
  thread_.Stop();
  if (closing_.joinable()) closing_.join();
}

void CameraNode::CloseLater(std::unique_ptr<GenicamCamera> camera) {
  if (closing_.joinable()) closing_.join();
  closing_ = std::thread([old = std::move(camera)]() mutable { old.reset(); });
}

void CameraNode::Serve(DeviceThread& thread) {
  newest_arrival_ = 0;
  clock_ = ClockFit();
  shutter_ = ShutterWatch();
  rate_since_ = SteadyUtime();
  rate_frames_ = 0;
  std::unique_ptr<GenicamCamera> camera;
  try {
    camera = std::make_unique<GenicamCamera>(spec_);
    Stream(camera.get(), &thread);
  } catch (const std::exception& e) {
    if (camera) CloseLater(std::move(camera));
    if (lost_since_ == 0 && newest_arrival_ != 0) lost_since_ = newest_arrival_;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (health_.streaming) ++health_.lost;
    health_.streaming = false;
    health_.rate_hz = 0;
    throw DeviceError(spec_.name + ": " + e.what());
  }
}

// Until it is to stop, or the camera is lost.
void CameraNode::Stream(GenicamCamera* camera, DeviceThread* thread) {
  using Trigger = CameraDevice::Trigger;
  const bool free_running = spec_.device->trigger == Trigger::kFree;
  for (const std::string& warning : camera->warnings()) WarnOf(warning, *thread);
  ptp_ = camera->FollowsPtp();
  if (!free_running) {  // it may send nothing for long
    const std::lock_guard<std::mutex> lock(mutex_);
    health_.streaming = true;
  }
  const Utime opened = SteadyUtime();
  Utime asked = 0;
  while (!thread->Stopping()) {
    if (TakeTrigger()) camera->Trigger();
    camera->Next(kWaitMs, [&](const CameraFrame& frame) { TakeFrame(*thread, frame); });
    const Utime now = SteadyUtime();
    const Utime silence = now - std::max(opened, newest_arrival_);
    if (free_running && silence > kSilence) {
      throw DeviceError("no frame for " + Seconds(silence) + "; is its cable plugged in?");
    }
    if (now - asked < kAskEvery) continue;
    asked = now;
    AskHealth(camera);
  }
}

bool CameraNode::TakeTrigger() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(trigger_, false);
}

void CameraNode::AskHealth(GenicamCamera* camera) {
  exposure_s_ = camera->ExposureSeconds().value_or(0);
  const auto celsius = camera->TemperatureCelsius();
  const Utime now = SteadyUtime();
  const std::lock_guard<std::mutex> lock(mutex_);
  health_.celsius = celsius;
  health_.rate_hz = static_cast<double>(rate_frames_) / ToSeconds(now - rate_since_ + 1);
  rate_frames_ = 0;
  rate_since_ = now;
}

Utime CameraNode::MiddleOfExposure(const CameraFrame& frame) {
  const Utime exposure = FromSeconds(exposure_s_);
  if (frame.device_utime == 0) return frame.arrival_utime - exposure / 2;  // it has no clock
  if (ptp_) {
    const auto start = PtpToUtc(frame.device_utime, frame.arrival_utime - exposure);
    if (start) return *start + exposure / 2;
  }
  clock_.Add(frame.device_utime, frame.arrival_utime, exposure);
  return clock_.ToHost(static_cast<double>(frame.device_utime)).value_or(frame.arrival_utime) +
         exposure / 2;
}

void CameraNode::CheckFits(const Image& image) const {
  if (image.pixels.cols != spec_.width || image.pixels.rows != spec_.height) {
    throw InputError("its frames are " + std::to_string(image.pixels.cols) + " x " +
                     std::to_string(image.pixels.rows) + " px, the rig file says " +
                     std::to_string(spec_.width) + " x " + std::to_string(spec_.height) +
                     "; they are dropped: set Width and Height, or correct the rig file");
  }
  CheckImage(spec_, image);
}

void CameraNode::TakeFrame(DeviceThread& thread, const CameraFrame& frame) {
  newest_arrival_ = std::max<Utime>(SteadyUtime(), 1);
  if (!frame.problem.empty()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++health_.incomplete;
    }
    WarnOf("a frame is not whole and was dropped: " + frame.problem, thread);
    return;
  }
  Image image;
  image.camera = spec_.name;
  image.utime = MiddleOfExposure(frame);
  image.frame_number = frame.number;
  image.device_utime = frame.device_utime;
  image.exposure_s = exposure_s_;
  try {
    Pixels pixels = PixelsOf(frame.format, frame.data, frame.size, frame.width, frame.height);
    image.format = pixels.format;
    image.pixels = std::move(pixels.pixels);
    CheckFits(image);
  } catch (const InputError& e) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++health_.unfit;
    }
    WarnOf(e.what(), thread);
    return;
  }
  if (spec_.kind == CameraKind::kThermal) {
    image.radiometry = spec_.radiometry;
    image.shutter_correcting = shutter_.Add(image.pixels, image.utime);
  }
  if (lost_since_ != 0) {
    WarnOf("back after " + Seconds(newest_arrival_ - lost_since_) + " without a frame", thread);
    lost_since_ = 0;
  }
  ++rate_frames_;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    health_.streaming = true;
    ++health_.frames;
    health_.shutter += image.shutter_correcting ? 1 : 0;
  }
  try {
    KeepRaw(image);
  } catch (const std::exception& e) {
    WarnOf(e.what(), thread);
  }
  Pack(&image);
  thread.Publish(std::move(image));
}

// The capture's image, where only a packed one leaves this host.
void CameraNode::KeepRaw(const Image& image) {
  Capture capture;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!capture_ || image.utime < capture_->utime || image.shutter_correcting) return;
    capture = *capture_;
    capture_.reset();
  }
  if (wire_ == CameraDevice::Wire::kRaw) return;
  const std::filesystem::path path = captures_ / capture.view / (spec_.name + ".png");
  std::filesystem::create_directories(path.parent_path());
  KeepAside(path);  // an earlier session's views may be called the same
  WritePng(path, image.pixels);
}

// For the wire; the bus compresses.
void CameraNode::Pack(Image* image) const {
  using Wire = CameraDevice::Wire;
  if (wire_ == Wire::kRaw) return;
  *image = Packed(std::move(*image), wire_ == Wire::kJpeg ? PixelFormat::kJpeg : PixelFormat::kPng);
}

Status CameraNode::GetStatus() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Status status;
  status.ready = health_.streaming;
  if (!health_.streaming) {
    status.text = health_.frames == 0 ? "waits for its camera" : "lost its camera, looks for it";
  } else {
    status.text = Format("%.1f frames/s", health_.rate_hz);
    if (health_.celsius) status.text += Format(", camera at %.0f deg C", *health_.celsius);
  }
  status.counters = {{"frames", health_.frames},
                     {"incomplete frames", health_.incomplete},
                     {"unfit frames", health_.unfit},
                     {"times lost", health_.lost},
                     {"shutter frames", health_.shutter}};
  return status;
}

}  // namespace rgbdt
