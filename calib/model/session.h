#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/time.h"

namespace rgbdt {

enum class SessionVerb {
  kNextPose = 1,  ///< put the board where the next view wants it
  kSweep = 2,     ///< turn the scanner once
  kCapture = 3,   ///< take this sweep and the cameras' next images as a view
  kSolve = 4,     ///< calibrate from all views so far
  kEvaluate = 5,  ///< judge the calibration on the held-out views
  kReset = 6,     ///< forget all views: a new session begins
  kGoOn = 7,      ///< an earlier session goes on: its results are made anew, its captures count
  kSayView = 8,   ///< say again all that the view was detected in, and its detection
};

/// What the session asks of everybody. Who is concerned answers with events of the same command.
struct SessionCommand {
  std::int64_t command = 0;  ///< its number: growing within a session, whose id is its high bits
  std::int64_t seq = 0;
  Utime utime = 0;  ///< newest sensor time that the session knew; 0 before the first
  SessionVerb verb = SessionVerb::kReset;
  std::string view;                         ///< next_pose, sweep, capture, say_view: its name
  Utime sweep_utime = 0;                    ///< capture, say_view: the sweep
  bool heldout = false;                     ///< sweep, capture
  std::vector<std::string> picked_cameras;  ///< capture: where a person picks the corners
};

enum class EventKind { kProgress = 1, kDone = 2, kFailed = 3 };

struct SessionEvent {
  std::int64_t command = 0;  ///< which command this answers
  std::int64_t seq = 0;
  Utime utime = 0;
  std::string source;  ///< process
  EventKind kind = EventKind::kDone;
  std::string text;       ///< for a person; with kFailed what, where and what to do
  Utime sweep_utime = 0;  ///< sweep done: its name; capture failed: the sweep that is not whole
  double fraction = 0;    ///< progress, 0 to 1
};

enum class SessionRequestKind {
  kNextPose = 1,   ///< have the board carried to its next place
  kPoseIsSet = 2,  ///< who carried it says that it stands
  kCapture = 3,    ///< turn the scanner once, take the view and solve
  kFinish = 4,     ///< judge, save, end the session
};

/// What a person asks of the session.
struct SessionRequest {
  std::int64_t seq = 0;
  Utime utime = 0;  ///< newest sensor time that the sender knew; 0 before the first
  SessionRequestKind request = SessionRequestKind::kCapture;
  bool heldout = false;  ///< capture: keep this view from the solver
};

/// Which views a person wants to be left out of the calibration: all of them.
struct LeftOutViews {
  std::int64_t seq = 0;
  Utime utime = 0;  ///< newest sensor time that the sender knew; 0 before the first
  std::vector<std::string> views;
};

/// Health of a process; sent at 1 Hz and when something happens.
struct Status {
  std::string process;
  std::int64_t seq = 0;
  Utime utime = 0;
  bool ready = false;
  std::string text;                                            ///< what it does or waits for
  std::string last_problem;                                    ///< newest thing dropped, and why
  std::vector<std::pair<std::string, std::int64_t>> counters;  ///< received, dropped, gaps, ...
};

/// The rig file as it travels.
struct RigText {
  std::int64_t seq = 0;
  std::string hash;
  std::string text;
};

/// The report as it travels: a `Report` (calib/files) as JSON.
struct ReportText {
  std::int64_t seq = 0;
  Utime utime = 0;
  std::string json;
};

/// Where the rig is: point_in_map = map_from_lidar * point_in_lidar.
struct StampedPose {
  std::int64_t seq = 0;
  Utime utime = 0;
  std::string source;
  Rigid3 map_from_lidar;
};

/// What a sweep tells of where the rig is: the `odometry_t` message.
struct SweepOdometry {
  std::int64_t seq = 0;
  Utime utime = 0;          ///< of the pose: when the sweep's last point was taken
  bool placed = false;      ///< false: no place was found, the pose is as the motion before goes on
  bool begun_anew = false;  ///< the map was: the way since the last pose is not known
  Rigid3 map_from_lidar;
  Vector6d velocity = Vector6d::Zero();    ///< rad/s, m/s in the LIDAR's axes
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta in LIDAR axes, truth = pose * Exp(delta)
  std::vector<std::string> untold;         ///< directions that the sweep does not tell, in words
  double residual_m = 0;                   ///< median distance of points from the map's planes
  std::string text;                        ///< for a person
};

}  // namespace rgbdt
