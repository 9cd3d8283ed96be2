#pragma once

#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {

/// Without what takes time and is judged elsewhere.
inline CalibrateOptions Brief() {
  CalibrateOptions options;
  options.diagnostics = false;
  return options;
}

inline SolveWorldOptions Views(int views) {
  SolveWorldOptions options;
  options.views = views;
  return options;
}

/// Of a camera's found pose, by its own covariance.
inline double Chi2(const SolveWorld& world, const Report& report, std::size_t camera) {
  const CameraCalibration& c = report.cameras[camera].calibration;
  return Chi2Of(world.camera_from_lidar[camera], c.camera_from_lidar, *c.covariance);
}

inline constexpr double kMostChi2 =
    22.5;  // of six degrees of freedom: one in a thousand lies beyond

}  // namespace rgbdt
