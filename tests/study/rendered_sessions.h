#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/options.h"
#include "tests/study/sampled_clouds.h"

namespace rgbdt::study {

struct RenderedOptions {
  int rings = 0;  ///< of the LIDAR; 0: the turned scanner
  int views = 8, heldout = 4;
  bool random_physics = false;                    ///< see RandomPhysics
  std::optional<simulate::BoardOptions> board{};  ///< absent: the usual one
};

struct RenderedSession {
  Rig rig;
  Truth truth;
  std::vector<ViewDetection> detections;  ///< one a view
  BeamModel model;                        ///< its ranges and where beams meet are as simulated
};

/// What sessions of random physics are drawn from, evenly: nothing of it is told to the estimator.
struct RandomPhysics {
  struct Range {
    double low, high;
  };
  struct Board {
    int squares_x, squares_y;
    double square_m, width_m, height_m;
  };
  Range blur_times{0.7, 1.5};  ///< each camera's
  Range black_reflectivity{0.05, 0.2}, white_reflectivity{0.5, 0.9};
  Range black_minus_white_k{2, 10};
  Range thickness_m{0.005, 0.025};
  Range focal_times{0.7, 1.3};                             ///< each camera's
  Range distortion_times{0, 1.5};                          ///< each camera's, all terms
  std::vector<Board> boards{{11, 8, 0.1, 1.2192, 0.9144},  // 4 ft x 3 ft
                            {11, 8, 0.1, 1.189, 0.841},    // A0
                            {9, 6, 0.1, 1.0, 0.7},         // B1 sheet
                            {10, 7, 0.08, 0.841, 0.594}};  // A1
};

/// The synthetic rig's options with what RandomPhysics allow, and then made imperfect
/// (simulate/imperfections.h), drawn from the seed.
void DrawPhysics(const RandomPhysics& ranges, std::uint64_t seed, simulate::Options* options);

/// A whole session, rendered and looked at as `rgbdt simulate` and `rgbdt calibrate` do, in memory:
/// scenes outdoor, indoor and night in turn. Throws InputError where the scene has no room.
RenderedSession RenderSession(const RenderedOptions& rendered, std::uint64_t seed);

}  // namespace rgbdt::study
