#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "calib/model/rgbdt_cloud.h"
#include "calib/model/rig.h"
#include "calib/scan_assembly/sweep_collector.h"
#include "services/foxglove/foxglove.pb.h"
#include "services/messages/bytes.h"
#include "services/messages/message.h"

namespace rgbdt {

/// What frames are to be called.
struct FoxgloveFrames {
  std::string lidar;                           ///< empty: as the rig calls the LIDAR
  std::map<std::string, std::string> cameras;  ///< by camera; not in it: `<camera>_optical_frame`
};

/// A message of Foxglove's on its way.
struct FoxgloveMessage {
  std::string topic;
  const google::protobuf::Descriptor* schema = nullptr;
  Utime log = 0;   ///< the newest sensor time so far
  Utime sent = 0;  ///< its own
  /// Of what holds until it is said anew: whose it is among those of its topic, "rgb". Empty: it is
  /// of its moment.
  std::string holds_for;
  bool large = false;                      ///< an image or a cloud
  std::function<std::string()> serialize;  ///< its bytes; it may be called later, in any thread
};

/// A type with all that it names: a FileDescriptorSet, as MCAP and WebSocket want it.
std::string DescribeSchema(const google::protobuf::Descriptor& type);

/// What travels on the bus as Foxglove's messages, live or from a log:
///
/// - /lidar/points, of CLOUD: PointCloud, a message a sweep; lines that never came are NaN;
/// - /fused/points, of RGBDT_SWEEP, or else RGBDT_CLOUD: PointCloud, a message a fused sweep;
/// - /CAMERA/image_raw, of CAMERA_IMAGE: RawImage, or at .../compressed CompressedImage;
/// - /CAMERA/camera_info, of RIG and CALIBRATION: CameraCalibration, the lens, solved or not;
/// - /tf_static, of RIG and CALIBRATION: FrameTransforms, LIDAR to camera; the guess until solved;
/// - /tf and /pose, of POSE: FrameTransforms and PoseInFrame, map to LIDAR;
/// - /status, /events, /mount_check, of STATUS, SESSION_EVENT, MOUNT_CHECK: Log.
///
/// Memory: the sweep under way, of CLOUD and of RGBDT_CLOUD. A calibration that is not to be used
/// gives no transform.
class FoxgloveStream {
 public:
  struct Options {
    FoxgloveFrames frames;
    std::string lidar = "lidar";  ///< its frame until a rig says another name
    Utime start = 0;              ///< nothing is logged before it
    bool fused_sweeps = false;    ///< RGBDT_SWEEPs come: RGBDT_CLOUD says the same twice
  };
  using Sink = std::function<void(FoxgloveMessage message)>;

  FoxgloveStream(Options options, Sink sink);

  /// `image_file`: of an image that was sent as JPEG or PNG (ImageFileOf). Throws InputError where
  /// it cannot be used: it is then as if it had never come.
  void Take(const Message& message, const Bytes& image_file = {});
  /// Nothing more comes: what waits for its end goes out.
  void Finish();

  std::int64_t torn_sweeps() const { return torn_sweeps_; }  ///< lines or the end never came

 private:
  template <typename M>
  void On(const M& /*of no such channel*/) {}
  void On(const CloudChunk& chunk);
  void On(const RgbdtCloud& cloud);
  void On(const StampedPose& pose);
  void On(const RigText& rig);
  void On(const CalibrationMessage& message);
  void On(const Status& status);
  void On(const SessionEvent& event);
  void On(const MountCheck& check);
  void TakeImage(const Image& image, const Bytes& file);
  void ForgetUnended();
  void FlushFused();
  void PutLens(const CameraSpec& camera);
  void PutCamera(const std::string& camera, const Rigid3& camera_from_lidar, Utime sent = 0);
  template <typename M>
  void Put(const std::string& topic, const M& message, Utime sent = 0,
           const std::string& holds_for = "");
  template <typename Data>
  void PutLarge(const std::string& topic, Data data, const std::string& frame, Utime sent = 0);
  std::string FrameOf(const std::string& camera) const;

  FoxgloveFrames frames_;
  Sink sink_;
  Utime now_;
  std::string lidar_;
  bool fused_sweeps_;
  SweepCollector sweeps_;
  std::set<Utime> under_way_;  // sweeps whose end has not come
  std::int64_t torn_sweeps_ = 0;
  std::optional<RgbdtCloud> fused_;
  std::optional<Rig> rig_;
  std::map<std::string, CalibrationMessage> calibrations_;  // those to be used
  std::map<std::string, std::string> not_used_, problems_;
};

}  // namespace rgbdt
