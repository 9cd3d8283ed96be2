#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "services/drivers/device_report.h"
#include "services/drivers/lidar/pending_sweeps.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// A real LIDAR, or a recording of one: what the rig's lidar.device names.
///  - Hokuyo -> LINE_SCAN. Answers nothing: the motor sweeps.
///  - Velodyne, Ouster, Hesai, Livox, RoboSense or a folder of PCD files -> CLOUD, each sweep when
///  it is complete. Hears
///    SESSION_COMMAND: a sweep command is done with the first whole sweep that began after the
///    command came.
class LidarNode : public DeviceNode {
 public:
  /// Throws InputError where the rig names no device, or its file or folder cannot be read.
  explicit LidarNode(const LidarSpec& lidar);
  ~LidarNode() override;

  std::string name() const override { return "lidar"; }
  std::vector<std::string> Subscriptions() const override;
  Messages Handle(const Message& message) override;
  Status GetStatus() const override { return source_->report().GetStatus(); }
  Messages Advance(Utime now) override;
  bool finished() const override { return thread_->ended(); }

  /// What serves the device.
  class Source {
   public:
    virtual ~Source() = default;
    virtual void Serve(DeviceThread& thread) = 0;
    virtual const DeviceReport& report() const = 0;
    virtual bool sweeps() const = 0;  ///< gives whole sweeps
    virtual bool live() const = 0;    ///< its times are now
  };

 private:
  std::optional<PendingSweeps::Clocks> Now() const;
  void AnswerWith(const CloudChunk& chunk, Messages* messages);
  void FailPending(Messages* messages);

  std::unique_ptr<Source> source_;
  PendingSweeps pending_;
  std::unique_ptr<DeviceThread> thread_;  // last: it uses the source
};

}  // namespace rgbdt
