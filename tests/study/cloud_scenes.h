#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

/// A kind of cloud: from which LIDAR, how far away, and what stands about.
struct CloudClass {
  std::string name;
  int rings = 0;                               ///< 0: the turned scanner
  double min_range_m = 1.5, max_range_m = 10;  ///< of the board's centre, evenly spread
  std::string clutter;                         ///< "door", "person", ...; empty: none
  int share_percent = 100;                     ///< of the scenes asked for, that it gets
};

/// Every LIDAR alone; then the turned scanner and 32 rings with each thing that looks like a board.
std::vector<CloudClass> CloudClasses();

/// Switches a thing of ClutterOptions on by its name. Throws InputError for an unknown one.
void AddClutter(const std::string& name, simulate::ClutterOptions* clutter);

/// One rendered cloud with its truth.
struct CloudScene {
  Cloud cloud;
  Target target;
  Rigid3 lidar_from_target;
  double range_sigma_m = 0;  ///< the LIDAR's
  std::string form;          ///< "organised", "ring" (not organised, with rings) or "bare"
  std::string scene;         ///< "outdoor", ...
};

/// Renders scenes 0 ... count - 1 of a class and hands each over: in the three scenes in turn, at
/// any roll, wholly in the LIDAR's field, every second one as a cloud that is not organised.
void RenderClouds(const CloudClass& cloud_class, int count, std::uint64_t seed,
                  const std::function<void(int, const CloudScene&)>& take);

/// What the study calls the board: a pose no farther off than this, up to half a turn.
inline constexpr double kFoundDeg = 5;
inline constexpr double kFoundMm = 100;

/// How far a pose of the board is off.
struct PoseError {
  double rotation_deg = 0;  ///< up to half a turn
  double centre_mm = 0;     ///< of the board's centre
  double chi2 = 0;          ///< of all six, by the stated covariance: 6 on average
  bool IsBoard() const { return rotation_deg <= kFoundDeg && centre_mm <= kFoundMm; }
};
PoseError ErrorOf(const TargetPose& pose, const Rigid3& sensor_from_target);

/// Index of the first candidate that is the board; -1: none is.
int FindAmong(const std::vector<CloudEdges>& candidates, const Rigid3& lidar_from_target);

}  // namespace rgbdt::study
