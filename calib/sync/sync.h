#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "calib/model/statistics.h"
#include "calib/model/time.h"

namespace rgbdt {

/// The board in one image.
struct WavedImage {
  Utime utime = 0;  ///< of the middle row, by the camera's clock
  /// Inner corners [px] in the target's order, each image's up to half a turn; NaN: not seen.
  std::vector<Eigen::Vector2d> corners;
};

/// A board that was found in a sweep.
struct SweepBoard {
  Utime utime = 0;  ///< when the beams were on its middle
  Rigid3 lidar_from_target;
};

/// One revolution of a spinning LIDAR: what returned, and when. LIDAR frame.
struct WavedSweep {
  std::vector<Eigen::Vector3f> points;  ///< [m]
  std::vector<Utime> utime;             ///< of each point, by the LIDAR's clock
  /// What may be the board, likeliest first; read only where no camera's pose is known.
  std::vector<SweepBoard> boards;
};

/// The hits of a sweep nearer than `most_range_m`. Throws InputError where it has no times.
WavedSweep TakeWavedSweep(const Cloud& cloud, double most_range_m);

struct WavedCamera {
  CameraSpec spec;                          ///< with the lens that belongs to the pose
  std::optional<Rigid3> camera_from_lidar;  ///< where the search begins; absent: from the sweeps
  /// How well that is known (CameraCalibration::covariance). Absent: not at all.
  std::optional<Matrix6d> covariance;
  std::vector<WavedImage> images;
};

/// A board that is waved before the sensors, or a rig that turns before a board that stands.
struct WavedBoard {
  Target target;                                          ///< with a checkerboard
  double range_sigma_m = 0.01, range_offset_sigma_m = 0;  ///< LidarSpec's
  std::vector<WavedSweep> sweeps;
  std::vector<WavedCamera> cameras;
};

struct SyncOptions {
  double most_offset_s = 1;     ///< offsets are looked for within this, either way
  double margin_m = 0.04;       ///< points nearer to the board's outline are not used
  double least_speed = 0.1;     ///< [m/s or rad/s] RMS; a board that moves less tells nothing
  double most_sigma_s = 0.005;  ///< an offset that is known worse is not given
  double clock_step_s = 1;      ///< between places at which a changing offset is looked at
  double most_gap_s = 0.25;     ///< nothing is used across a longer gap between images

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The offset at one time.
struct OffsetAt {
  double seconds = 0;  ///< since SyncResult::start
  Estimate offset_s;
};

/// What is found of one camera.
struct SyncedCamera {
  std::string camera;
  std::string why_not;  ///< why nothing is given; empty: it is
  /// The LIDAR's time of an image's middle row is its utime + this. Of a clock that drifts or jumps
  /// the mean, its sigma widened to all of its values; beyond most_sigma_s it is not given.
  Estimate time_offset_s;
  /// From the first row's exposure to the last one's; below 0: the last row comes first.
  Estimate rolling_s;
  Rigid3 camera_from_lidar;
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta (rigid3.h), camera axes
  std::vector<OffsetAt> offsets;           ///< over time, against the mean; each of its own
  std::optional<Estimate> drift;           ///< [s/s]; only where it is more than chance
  std::optional<OffsetAt> jump;            ///< when, and by how much the offset grew; likewise
  std::vector<std::string> warnings;
  int images = 0, repeated = 0;  ///< used; left out, as they show again what one before showed
  double corner_rms_px = 0;      ///< about the poses of single images
  double variance_factor = 1;    ///< by which the images' covariance was enlarged, as they scatter
};

struct SyncResult {
  std::vector<SyncedCamera> cameras;
  /// Where times begin, by the LIDAR's clock: the first sweep's first point, or a second before the
  /// first image of the board where that is later. 0: nothing was solved.
  Utime start = 0;
  int sweeps = 0;                          ///< with the board
  double seconds = 0;                      ///< from the first to the last of these
  double speed = 0, turn_speed = 0;        ///< of the board, RMS [m/s, rad/s]
  double plane_rms_m = 0;                  ///< of points from the board, along their beams
  double variance_factor = 1;              ///< by which the sweeps' covariance was enlarged
  std::optional<Estimate> range_offset_m;  ///< by which ranges are too long; absent: held at 0
};

/// When each camera sees what its images say. The board's way through the LIDAR's frame is a cubic
/// B-spline (R^3 x SO(3), a knot every 50 to 100 ms); corners lie on it at the times of their rows,
/// points at their beams' times; each camera's offset, read-out and pose, and the range offset are
/// solved for with it (README.md). No guess of an offset is needed. A camera that does not tell has
/// the reason in `why_not`; the others are given without it. What lies more than a second before
/// the first image of the board or after the last is not used. Throws InputError for input that
/// makes no sense, or whose images and sweeps go on together for more than 600 s.
SyncResult Synchronise(const WavedBoard& input, const SyncOptions& options = {});

/// What an offset does that nobody takes out, in words with pixels: at 1 m/s across, 3 m away, and
/// at 1 rad/s. `what`: how the offset is called.
std::string OffsetInPixels(const CameraSpec& spec, double offset_s);

}  // namespace rgbdt
