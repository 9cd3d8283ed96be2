#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "calib/odometry/odometry.h"
#include "calib/scan_assembly/sweep_collector.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// CLOUD -> POSE and ODOMETRY (calib/odometry). Of each sweep that was taken one ODOMETRY: the pose
/// of its last point with covariance and the directions that it does not tell. POSE: of a spinning
/// LIDAR one a sweep, of the time of its last point; where there was none before, one of the
/// sweep's middle, too, so that a track of them moves. Of a turned scanner whose rig stands while
/// it sweeps, the same one from the sweep's begin to its end, two a second; where it drives
/// meanwhile, ten a second, the last second's with the next sweep that it drives through. Each
/// sweep is taken when its end comes, and once: nothing waits. A sweep that lacks lines is taken as
/// it is. No POSE goes out for a sweep of which no place was found; for one that does not tell a
/// direction it does, and the status names the direction. A sweep that is older than the one before
/// is refused. Where the map is begun anew it goes on from the last pose, with a warning: the way
/// in between is not known.
class OdometryNode : public Node {
 public:
  static constexpr const char* kSource = "odometry";

  /// Is told of each sweep that was taken, and what came of it.
  using Taken = std::function<void(const Cloud&, const OdometryResult&)>;

  explicit OdometryNode(const OdometryOptions& options = {}, Taken taken = {})
      : odometry_(options), tell_(std::move(taken)) {}

  std::string name() const override { return "odometry"; }
  std::vector<std::string> Subscriptions() const override { return {"CLOUD"}; }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

  /// Of the newest sweep.
  const OdometryResult& newest() const { return newest_; }

 private:
  Messages PosesOf(const OdometryResult& before);
  SweepOdometry Told() const;
  std::string Text() const;

  Odometry odometry_;
  Taken tell_;
  SweepCollector sweeps_;
  OdometryResult newest_;
  Utime told_until_ = 0;  // of the newest pose
  std::int64_t taken_ = 0, poses_ = 0, not_placed_ = 0, degenerate_ = 0, restarts_ = 0;
};

}  // namespace rgbdt
