#pragma once

#include <map>
#include <string>
#include <vector>

namespace rgbdt::simulate {

inline constexpr double kDegree = 3.14159265358979323846 / 180;

/// The beam of any LIDAR: its width, what it returns and its noise.
struct BeamOptions {
  double range_sigma_m = 0.010;          ///< noise of a range
  double divergence_rad = 2.7e-3;        ///< full angle of the beam's cone, evenly filled
  int divergence_rings = 2;              ///< sub-rays: 1 + 3 n (n + 1), so 19
  double merge_m = 0.5;                  ///< surfaces closer together than this in range merge
  double min_return = 0.02;              ///< of what the whole beam returns from the white wall
  double white_wall_reflectivity = 1.0;  ///< of that wall
  double max_range_m = 60;               ///< nothing returns from farther away
  double intensity_sigma = 0.01;         ///< noise of an intensity (0 to 1)
  double range_offset_m = 0;             ///< all ranges are measured this much too long
  double dark_range_m = 0;               ///< black surfaces' ranges, too, against white ones'
  double dark_noise = 1;                 ///< black surfaces' noise of ranges over white ones'

  /// Throws InputError naming the field, with `prefix` before it, and its value.
  void Check(const std::string& prefix) const;
};

/// A spinning multi-beam LIDAR in the LIDAR frame's origin, turning about z from x towards y.
struct SpinningOptions : BeamOptions {
  std::vector<double> elevations_rad;         ///< one a ring, rising: ring 0 is the lowest
  double azimuth_step_rad = 0;                ///< rounded so that a revolution is whole steps
  double first_azimuth_rad = -180 * kDegree;  ///< of column 0: where the grid's seam lies
  double revolution_s = 0.1;                  ///< rings of a column fire within a step's time:
  double firing_share = 0;       ///< over this share of it, one ring after the other while
                                 ///< the head turns; 0: all at once
  double ring_bias_sigma_m = 0;  ///< each ring's ranges are off by a constant of its own
  /// Beams leave the axis at heights that differ by elevation, and meet in one height at this
  /// radius: that of elevation e starts at z = -beams_meet_m tan(e). Its point is published as if
  /// it had started at the origin. 0: all do.
  double beams_meet_m = 0;

  int rings() const { return static_cast<int>(elevations_rad.size()); }
  int columns() const;  ///< azimuths of a revolution
  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// LIDARs of 16 (-15 to 15 degrees), 32 (-30.67 to 10.67), 64 (-24.8 to 2) or 128 rings (-25 to
/// 15), evenly spaced. Throws InputError for another number.
SpinningOptions SpinningLidar(int rings);

enum class LivoxModel { kMid360, kAvia };

/// A LIDAR whose pattern does not repeat, in the LIDAR frame's origin (internal/livox.h). The beam
/// is an oval: divergence_rad high.
struct LivoxOptions : BeamOptions {
  LivoxModel model = LivoxModel::kMid360;
  double seconds = 1;                ///< of a cloud
  double points_per_s = 200'000;     ///< beams fired, all lasers together
  double divergence_across_rad = 0;  ///< full angle of the beam's width
  double angle_sigma_rad = 0;        ///< noise of a beam's angle, along either

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// By their data sheets: Avia, 240,000 points a second, beam of 0.28 by 0.03 degrees, angles to
/// 0.05 degrees, ranges to 20 mm; Mid-360, 200,000 points a second, angles to 0.15 degrees, ranges
/// to 20 mm, and the Avia's beam, as its own is not published.
LivoxOptions LivoxLidar(LivoxModel model);

/// In place of a number of rings.
inline constexpr int kMid360 = -1, kAvia = -2;

/// As a person types them; 0 is the turned scanner.
inline const std::map<std::string, int> kLidarRings = {
    {"turned", 0}, {"vlp16", 16},   {"32", 32},         {"64", 64},
    {"128", 128},  {"avia", kAvia}, {"mid360", kMid360}};

}  // namespace rgbdt::simulate
