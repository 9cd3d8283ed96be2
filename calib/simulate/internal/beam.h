#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/simulate/internal/world.h"
#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// One sub-ray of a beam that met a surface.
struct SubReturn {
  double range = 0;  ///< [m]
  double reflectivity = 0;
};

struct BeamReturn {
  double range = 0;      ///< [m]; NaN: nothing returned
  double intensity = 0;  ///< reflectivity seen by the whole beam, range compensated
};

/// What a beam of `sub_rays` equal shares reports. Each return has energy reflectivity * share /
/// range^2. Returns within `merge_m` of the next merge to their energy-weighted mean range; of what
/// remains the strongest is reported, unless it is weaker than `min_return` of what the whole beam
/// would return from the white wall at that range. `returns` is sorted.
BeamReturn CombineReturns(const BeamOptions& options, int sub_rays,
                          std::vector<SubReturn>* returns);

/// Unit vectors that fill the cone of a beam evenly, the middle first. The beam lies in the x-z
/// plane, this much above x.
std::vector<Eigen::Vector3d> SubRays(const BeamOptions& options, double elevation_rad);

/// Beams from one point, each of `sub_rays` rays that follow one another in `directions` (unit,
/// LIDAR frame), without noise. Writes one return for each beam.
void CastBeams(const World& world, const BeamOptions& options, const Eigen::Vector3d& origin,
               const std::vector<Eigen::Vector3d>& directions, int sub_rays, BeamReturn* returns);

/// What a range is measured too long by [m], besides noise: all alike, and dark surfaces more,
///   range_offset_m + dark_range_m exp(-(reflectivity / 0.3)^2),
/// by what the whole beam returns.
double RangeError(const BeamOptions& options, const BeamReturn& back);

/// 1 sigma of a range's noise [m]: range_sigma_m of white surfaces, up to dark_noise times that of
/// dark ones,
///   range_sigma_m (1 + (dark_noise - 1) exp(-(reflectivity / 0.3)^2)).
double RangeSigma(const BeamOptions& options, const BeamReturn& back);

/// An intensity as it is reported: noisy, within 0 to 1; 0 of a miss. `noise`: standard normal.
float NoisyIntensity(const BeamOptions& options, const BeamReturn& back, double noise);

}  // namespace rgbdt::simulate
