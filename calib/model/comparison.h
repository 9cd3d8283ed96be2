#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/time.h"

namespace rgbdt {

/// Of a difference of two poses (6 degrees of freedom): by chance above it once in a thousand
/// times.
inline constexpr double kUnlikelyChi2 = 22.5;

/// By how much two poses project the points of one distance apart.
struct PixelShift {
  double distance_m = 0;
  double rms_px = 0;               ///< over the image
  std::optional<double> sigma_px;  ///< 1 sigma of rms_px by both covariances
};

/// One camera in two calibrations of a rig. Sigmas are of the difference, by both covariances; NaN
/// where one of the two has none, or has not converged.
struct PoseComparison {
  std::string camera;
  std::array<Estimate, 3> rotation_deg;  ///< from a to b, about the camera's x, y, z
  std::array<Estimate, 3> centre_mm;     ///< of the camera's centre, along the LIDAR's x, y, z
  PoseError difference;
  std::optional<double> chi2;      ///< six degrees of freedom; absent where sigmas are NaN
  std::vector<PixelShift> pixels;  ///< empty: no lens at hand
  bool same_lens = false;          ///< both have the very same; not known without one at hand
};

/// Two calibrations of a rig: b against a, whichever is the later one.
struct CalibrationComparison {
  std::string a, b;                ///< as the user named them
  Utime utime_a = 0, utime_b = 0;  ///< 0: not known
  bool same_rig = true;            ///< the rig files are the same, lenses and all
  std::string rigs_differ;   ///< in what, of what a pose depends on; empty: not known, or nothing
  std::string not_compared;  ///< cameras that only one of the two has, in words
  std::vector<PoseComparison> cameras;
};

/// In how many of its sigmas a single figure of a difference tells.
inline constexpr double kTellingSigmas = 3;

/// From which chance on a camera is said to have moved.
inline constexpr double kMovedChance = 0.01;

/// Whether a comparison says that a camera moved: beyond what chance does once in a hundred.
bool Moved(const PoseComparison& camera);

/// Whether colours lie farther apart, at some distance, than the covariances of both allow, by
/// lenses that differ: each solved from its own part of the image.
bool ColoursMoved(const PoseComparison& camera);

/// How often chance alone makes a chi-square of six degrees of freedom as large.
double ChanceOfChi2(double chi2);

}  // namespace rgbdt
