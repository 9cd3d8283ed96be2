#pragma once

namespace rgbdt {

// What is known of a LIDAR's beam and of a board before any data: the priors of the
// board's fit in one cloud (detect/cloud) and of the joint solve (solve). What a beam's width does
// to an edge is an angle, outwards positive: with range it becomes a length. All are sigmas about
// zero unless they say otherwise.

/// Shift of a class of crossing (CrossingKind) in one view. A beam returns what its stronger part
/// meets: one of 2.7 mrad widens an edge by up to 0.9 mrad where nothing or something far lies
/// behind it, and narrows it by as much where something lies just behind it or a black border
/// sends little back. Evenly spread over +-0.9 mrad that is a sigma of 0.52 mrad, and some more for
/// beams that are wider. One view hardly tells this shift from a shift of the whole board: where
/// opposite sides have different things behind them, this prior is what tells.
inline constexpr double kViewClassShiftSigmaRad = 0.6e-3;

/// The same shift where all views of a session share it, in the joint solve. There boards seen at
/// many ranges and against many backgrounds tell it, so the prior is only to keep a class that few
/// crossings have from running away: wide enough for beams of 4.5 mrad at their worst. The one
/// view's 0.6 mrad would hold shifts of wide beams back, in every view the same way, and their
/// error would go into the pose.
inline constexpr double kSharedClassShiftSigmaRad = 1.5e-3;

/// The same for boards without a pattern. A white one throws so much light back that the fringe of
/// a beam's cone is enough for a return: a recorded one (Ouster, 64 rings, 2.5 to 3.4 m) looks 24
/// to 29 mm too large at each side, 7 to 11 mrad.
inline constexpr double kPlainClassShiftSigmaRad = 3e-3;

/// The same where all views share it: as large as it was seen to be.
inline constexpr double kSharedPlainClassShiftSigmaRad = 8e-3;

/// What makes such a board look too large depends on how much light comes back, which falls with
/// the square of the range: the recorded one looks too large by a length rather than an angle. How
/// much of it is a length, where all views share it [m].
inline constexpr double kPlainFringeSigmaM = 0.03;

/// Further shift of each side in each view: what lies behind one side is not one class throughout.
/// Opposite sides' difference looks like a turn of the board: 0.3 mrad cost 0.013 degrees.
inline constexpr double kSideShiftSigmaRad = 0.3e-3;

/// How sharply one beam of 2.7 mrad tells inside from outside: where it swings over from one
/// surface to the other depends on noise and reflectivity by some seventh of its width.
inline constexpr double kCrossingBlurRad = 0.4e-3;

/// The board's thickness [m], mean and sigma: where its rim faces the LIDAR, the board looks wider.
/// Plywood, foam and aluminium composite are 3 to 20 mm thick.
inline constexpr double kBoardThicknessM = 0.010, kBoardThicknessSigmaM = 0.010;

/// Each side's place against the printed pattern, as a board is cut [m].
inline constexpr double kOutlineSigmaM = 0.001;

/// Width and height of the printed pattern, each over what its squares' size makes it, less one: as
/// printers feed paper and paper takes up damp. On the checkerboard of the recorded sessions the
/// squares are 0.4% lower than wide.
inline constexpr double kUsualPrintSigma = 0.003;

/// True range less measured range [m], where nothing is known of it; beyond what any LIDAR is off.
inline constexpr double kRangeOffsetSigmaM = 0.1;

/// The same of a LIDAR that is as its data sheet says: 20 to 30 mm is what most call their
/// accuracy.
inline constexpr double kUsualRangeOffsetSigmaM = 0.02;

/// The radius [m] at which a spinning LIDAR's beams meet (RangeErrors), beyond what its driver
/// makes of it: Velodyne's lasers fire from heights that make it 42 mm, which not all drivers know.
inline constexpr double kBeamsMeetSigmaM = 0.05;

/// The same where it is taken for zero: small enough to pin it, large enough to be inverted.
inline constexpr double kNoBeamsMeetSigmaM = 1e-7;

/// The same where it is taken for zero: small enough to pin it, large enough to be inverted.
inline constexpr double kNoFringeSigmaM = 1e-9, kNoRangeOffsetSigmaM = 1e-9, kNoPrintSigma = 1e-9;

}  // namespace rgbdt
