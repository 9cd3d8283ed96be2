#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "calib/model/rig.h"
#include "services/drivers/camera/genicam_camera.h"
#include "services/drivers/camera/shutter_watch.h"
#include "services/drivers/clock_fit.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// How a camera's images travel: as its rig file says; else raw on a bus that stays on this
/// machine, and packed on one that leaves it, JPEG in colour, PNG (without loss) of a thermal
/// camera.
CameraDevice::Wire WireOf(const CameraSpec& camera, bool leaves_machine);

/// One GigE Vision or USB3 Vision camera -> `<CAMERA>_IMAGE`. Frames that are not whole, or not of
/// the rig file's size, are dropped, counted and named; none of them is published. A camera that is
/// lost is looked for until it is back, and the gap is a warning.
///
/// `utime` is the exposure's middle on the host's clock: the device's stamps through ClockFit,
/// where a frame's first packet leaves at the exposure's end at the earliest. So it does not matter
/// whether a device stamps the exposure's start or its end. A device that follows PTP is taken at
/// its word (PtpToUtc): its stamp is the exposure's start.
///
/// Where images go out as JPEG or PNG, SESSION_COMMAND capture leaves that view's image raw in
/// `captures`, on this host. With software triggers a capture takes an image, and nothing else
/// does.
class CameraNode : public DeviceNode {
 public:
  /// Without a frame for so long, a free-running camera counts as lost. It is the time after which
  /// a GigE Vision camera gives up who controls it: before, it goes on by itself, after, it can be
  /// opened anew.
  static constexpr Utime kSilence = 3 * kMicrosecondsPerSecond;

  /// Frames that wait for the bus, which packs them; the oldest go first.
  static constexpr std::size_t kMaxWaiting = 8;

  /// `camera`: its name; empty where only one camera of the rig has a device. `leaves_machine`: the
  /// bus does (WireOf). Throws InputError where the rig file has no device for it, or there is a
  /// choice.
  CameraNode(const Rig& rig, const std::string& camera, std::filesystem::path captures,
             bool leaves_machine);
  ~CameraNode() override;

  std::string name() const override { return "camera-" + spec_.name; }
  std::vector<std::string> Subscriptions() const override { return {"SESSION_COMMAND"}; }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;
  Messages Advance(Utime /*now*/) override { return TakeFrom(&thread_); }
  bool finished() const override { return thread_.ended(); }

 private:
  // What the status tells.
  struct Health {
    bool streaming = false;  // or ready to, where a trigger is waited for
    double rate_hz = 0;
    std::optional<double> celsius;
    std::int64_t frames = 0, incomplete = 0, unfit = 0, lost = 0, shutter = 0;
  };
  struct Capture {
    std::string view;
    Utime utime = 0;
  };

  void Serve(DeviceThread& thread);
  void Stream(GenicamCamera* camera, DeviceThread* thread);
  void CloseLater(std::unique_ptr<GenicamCamera> camera);
  void TakeFrame(DeviceThread& thread, const CameraFrame& frame);
  void CheckFits(const Image& image) const;
  bool TakeTrigger();
  Utime MiddleOfExposure(const CameraFrame& frame);
  void KeepRaw(const Image& image);
  void Pack(Image* image) const;
  void AskHealth(GenicamCamera* camera);
  void WarnOf(const std::string& what, DeviceThread& thread) const;

  CameraSpec spec_;
  std::filesystem::path captures_;
  CameraDevice::Wire wire_;

  mutable std::mutex mutex_;  // of these three
  Health health_;
  std::optional<Capture> capture_;
  bool trigger_ = false;

  // The device thread's own.
  ClockFit clock_;
  ShutterWatch shutter_;
  bool ptp_ = false;
  double exposure_s_ = 0;
  Utime newest_arrival_ = 0;  // of a frame, whole or not; 0: none since the camera was opened
  Utime lost_since_ = 0;      // 0: it is not
  std::int64_t rate_frames_ = 0;
  Utime rate_since_ = 0;
  std::thread closing_;  // of a camera that was lost: its farewells time out one after the other

  DeviceThread thread_;  // last: it uses all the others
};

}  // namespace rgbdt
