#pragma once

// Inside calib/scan_assembly only: pieces of surface that both halves of the scan line saw.

#include <vector>

#include "calib/scan_assembly/internal/beam_planes.h"

namespace rgbdt {

/// What makes a patch, and how fine to look.
struct PatchSearch {
  double sigma_m = 0.01;    ///< of a range, or more where halves are still bent
  double slack = 1.3;       ///< see FitPlane
  double max_turn_rad = 0;  ///< between the halves' planes
  double max_gap_m = 0;     ///< between them, at their middle
  int first_level = 3;      ///< directions are cut into 6 * 4^level tiles
  int last_level = 6;
};

/// A piece of surface seen by both halves.
struct ScanPatch {
  BeamPlane before, behind;  ///< as each half has it
  BeamPlane joint;           ///< the one plane that fits both best
  double gap_m = 0;          ///< `before` less `behind` along the joint normal, at its centre

  /// What the one plane fits worse than the two: chi-square of three degrees of freedom where the
  /// geometry is right.
  double Misfit() const { return joint.chi2 - before.chi2 - behind.chi2; }
};

struct PatchList {
  std::vector<ScanPatch> patches;
  int tiles = 0;        ///< first-level tiles with beams enough to judge
  int tiles_twice = 0;  ///< of these, seen by both halves
};

/// Tiles are of directions, a quadtree on the faces of a cube round the scanner: which beams share
/// a tile does not depend on the noise of their ranges. A tile that is no single plane to both
/// halves is cut into four.
PatchList FindPatches(const PlacedBeams& all, const PatchSearch& search);

/// The same beams under another geometry.
void RefitPatch(const PlacedBeams& all, double sigma_m, ScanPatch* patch);

/// Sigma of a range [m] as small flat pieces have it, each seen by one half: it does not depend on
/// the geometry. 0: there are none.
double RangeNoise(const PlacedBeams& all);

}  // namespace rgbdt
