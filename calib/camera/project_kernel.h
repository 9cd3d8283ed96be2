#pragma once

// Inside calib/camera only: the loop of project_points.h. Its file is built for the widest SIMD
// that the machine has, so no Eigen type crosses this border: their alignment differs.

#include <cstddef>

namespace rgbdt {

struct PixelArrays {
  float *u, *v, *inverse_range;
};

/// PointProjection as the kernel takes it.
struct KernelProjection {
  bool fisheye, rolls;
  float rotation[9], translation[3], distortion[8];
  float fx, fy, cx, cy, min_cos_angle;
  float delta_per_row[6], middle_row;
};

/// As many points as PixelBlock holds, at most.
void ProjectKernel(const KernelProjection& projection, const float* points, std::size_t count,
                   const PixelArrays& out);

/// Least and most x, y and z of points: one or more.
void FindBox(const float* points, std::size_t count, float* least, float* most);

}  // namespace rgbdt
