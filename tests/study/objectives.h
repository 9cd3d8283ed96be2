#pragma once

#include <deque>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/solve/board_problem.h"
#include "calib/solve/distance_field.h"
#include "tests/study/paired_sessions.h"

namespace rgbdt::study {

/// The parameters of the paper's Figures 8 and 9, in this order.
inline const std::vector<std::string> kParameters = {"roll", "pitch", "yaw", "x", "y", "z"};
constexpr double kMostTurnDeg = 30;
constexpr double kMostShiftM = 3;

/// A pose moved by roll, pitch and yaw [deg] about the LIDAR's x, y and z and by x, y and z [m]
/// along them: the points are, before they go into the camera.
Rigid3 Moved(const Rigid3& camera_from_lidar, const std::array<double, 6>& by);

/// One camera's views as the joint solve takes them, boards and half turns chosen by a pose.
BoardProblem ProblemOf(const PairedSession& session, std::size_t camera, int views,
                       const Rigid3& camera_from_lidar);

/// What `paper` and `auto` minimise, for one camera and the first so many views of a session, as a
/// root mean square: a monotone function of the sum, so with the same minima.
class Objectives {
 public:
  /// `session` outlives it.
  Objectives(const PairedSession& session, std::size_t camera, int views);

  /// Of the distances [px] of the boundary points from the edge pixels.
  double Paper(const Rigid3& camera_from_lidar, FieldBeyond beyond) const;
  /// Of the whitened, robust distances of crossings and points from the board where the camera
  /// sees it; shifts of sides and edges as the solve from the truth leaves them.
  double Auto(const Rigid3& camera_from_lidar) const;

  const Rigid3& truth() const { return truth_; }

 private:
  Camera camera_;
  Rigid3 truth_;
  std::vector<CameraView> by_paper_;
  std::deque<DistanceField> flat_, smooth_;
  BoardProblem problem_;
  BoardState state_;
  double boards_residuals_ = 0;
};

}  // namespace rgbdt::study
