#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "tests/study/sampled_clouds.h"

namespace rgbdt::study {

struct SampledOptions {
  int rings = 0;  ///< of the LIDAR; 0: the turned scanner
  int views = 8, heldout = 4;
  /// All ranges are off by a constant, drawn evenly from -this to this; 0: they are exact, and the
  /// rig says so.
  double range_offset_m = 0;
  /// The rig's lenses are off by what it says of them (LensOff); false: exact, and it says so.
  bool lenses_off = false;
  /// The printed pattern's width and height are each off by this, relative (1 sigma), and the board
  /// is not flat (kBowSigmaM); the rig says so. 0: as it was drawn.
  double print_sigma = 0;
  /// The LIDAR is off by what real ones are, see DrawBeamPhysics.
  bool physics = false;
  /// Rings of spinning LIDARs beside that one, each with a beam model of its own.
  std::vector<int> further_rings{};
};

/// By what a lens of the rig is off (1 sigma): 0.4% of fx and of fy, 6 px in the centre, 0.02 in
/// k1.
LensUncertainty LensOff(const Lens& lens);

/// What a LIDAR of so many rings (0: a scanner) is off by, drawn from the seed: a constant of all
/// ranges, which the rig states as well as it is known (20 mm); rings' offsets, with a sigma of 3
/// to 10 mm of their own; black against white, 0 to 20 mm; where beams meet, 0 to 45 mm; and the
/// edges' classes, with a sigma of 0.6 to 1.5 mrad. Of a scanner there are no rings, and its beams
/// meet.
void DrawBeamPhysics(int rings, std::uint64_t seed, BeamModel* model);

/// What the noise model drew in one view.
struct SampledView {
  std::string name;
  bool heldout = false;
  Rigid3 lidar_from_target;
  BeamWindow beams;
  std::array<CrossingKind, 4> behind{};
  Cloud cloud;  ///< organised, as large as the window
};

struct SampledSession {
  Rig rig;
  std::vector<CameraSpec> true_cameras;  ///< the rig's with their true lenses
  TrueBoard true_board;                  ///< the rig's as it is
  BeamModel model;
  Truth truth;
  std::vector<SampledView> views;
  std::vector<ViewDetection> detections;  ///< one a view, further LIDARs' clouds with it
};

/// "0001" for view 0: as `rgbdt simulate` names them.
std::string ViewName(int index);

/// Whether view `index` of so many is held out: every third of 8 + 4.
bool IsHeldOut(int index, int views, int heldout);

/// A whole session from the noise model, nothing rendered: the simulator's default cameras, mounts
/// and board poses as it draws them, wholly in all sensors. Corners are sampled; the board in the
/// cloud is found and its crossings are made by the library's own detector. Nothing where this
/// seed's scene has no room for so many views.
std::optional<SampledSession> SampleSession(const SampledOptions& options, std::uint64_t seed);

}  // namespace rgbdt::study
