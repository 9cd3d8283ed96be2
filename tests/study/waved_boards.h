#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/simulate/waving.h"
#include "calib/sync/sync.h"

namespace rgbdt::study {

/// A board waved for some seconds before a simulated rig.
struct WavedScene {
  simulate::Options options;
  simulate::WaveOptions wave;
  std::vector<simulate::ClockOptions> clocks;  ///< one a camera
  std::vector<double> rates_hz;                ///< likewise: free-running, each with a phase
  double seconds = 20;
  double sweep_s = 0;   ///< between two sweeps that are taken; 0: every one
  double jitter_s = 0;  ///< of the images' times, RMS: a software trigger
};

/// A colour camera at 20 Hz and a thermal one at 9 Hz, a LIDAR of so many rings, clocks exact.
WavedScene TwoCameras(std::uint64_t seed, int rings = 32);
/// The colour camera alone.
WavedScene ColorCamera(std::uint64_t seed, int rings = 32);

/// What detection would make of it: corners with SampledCorners' noise, each image in either order,
/// and sweeps by beams. Without poses; `truth`: where the cameras sit.
WavedBoard SampleWavedBoard(const WavedScene& scene, Truth* truth);

/// Every camera's search begins at the truth, turned and shifted by so much, and nothing more is
/// known of it; `known`: to so much.
void BeginNearTruth(const Truth& truth, double turn_rad, double shift_m, WavedBoard* board);

/// For each sweep the board as detection in clouds would find it: 10 mm and 0.5 degrees off, turned
/// by half a turn or not.
void AddSweepBoards(const WavedScene& scene, WavedBoard* board);

}  // namespace rgbdt::study
