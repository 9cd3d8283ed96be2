#include "calib/camera/project_kernel.h"

#include <cmath>

#include "calib/camera/simd_dispatch.h"

namespace rgbdt {
namespace {

constexpr float kHalfPi = 1.57079632679F;
constexpr float kPi = 3.14159265359F;
constexpr float kMost = 1e6F;  // of a pixel, and of an inverse range

// The angle of (x, y), y >= 0, from the x axis: 0 to pi, within 3e-7 rad. Without branches, so that
// the loop is vectorised. Polynomial: Abramowitz and Stegun 1964, 4.4.49.
inline float AngleOf(float x, float y) {
  const float ax = std::fabs(x);
  const float more = ax < y ? y : ax;
  const float less = ax < y ? ax : y;
  const float a = less / (more + 1e-30F);
  const float s = a * a;
  float p = -0.0161657367F + s * 0.0028662257F;
  p = 0.0429096138F + s * p;
  p = -0.0752896400F + s * p;
  p = 0.1065626393F + s * p;
  p = -0.1420889944F + s * p;
  p = 0.1999355085F + s * p;
  p = -0.3333314528F + s * p;
  p = a + a * s * p;
  p = ax < y ? kHalfPi - p : p;
  return x < 0 ? kPi - p : p;
}

constexpr std::size_t kBlock = 512;  // points at a time, side by side in columns: PixelBlock's

struct Pixel {
  float u, v;
};

enum class Bend { kPolynomial, kRational, kFisheye };

template <Bend kBend>
inline Pixel Lens(const KernelProjection& k, float x, float y, float z) {
  const float* d = k.distortion;
  if (kBend == Bend::kFisheye) {
    const float r = std::sqrt(x * x + y * y);
    const float theta = AngleOf(z, r);
    const float t2 = theta * theta;
    const float bent = theta * (1 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
    // On the axis theta / r tends to 1 / z.
    const float scale = (r > 1e-9F ? bent : 1.0F) / (r > 1e-9F ? r : z);
    return {k.fx * (x * scale) + k.cx, k.fy * (y * scale) + k.cy};
  }
  const float iz = 1 / z;
  const float a = x * iz;
  const float b = y * iz;
  const float r2 = a * a + b * b;
  float radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  if (kBend == Bend::kRational) radial /= 1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
  const float ab2 = 2 * a * b;
  const float bent_a = a * radial + d[2] * ab2 + d[3] * (r2 + 2 * a * a);
  const float bent_b = b * radial + d[2] * (r2 + 2 * b * b) + d[3] * ab2;
  return {k.fx * bent_a + k.cx, k.fy * bent_b + k.cy};
}

template <Bend kBend, bool kRolls>
inline __attribute__((always_inline)) void Run(const KernelProjection& k,
                                               const float* __restrict points, std::size_t count,
                                               float* __restrict u, float* __restrict v,
                                               float* __restrict w) {
  const float* r = k.rotation;
  const float* t = k.translation;
  const float* m = k.delta_per_row;
  float column_x[kBlock];
  float column_y[kBlock];
  float column_z[kBlock];
  for (std::size_t i = 0; i < count; ++i) {
    column_x[i] = points[3 * i];
    column_y[i] = points[3 * i + 1];
    column_z[i] = points[3 * i + 2];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float px = column_x[i];
    const float py = column_y[i];
    const float pz = column_z[i];
    float x = r[0] * px + r[1] * py + r[2] * pz + t[0];
    float y = r[3] * px + r[4] * py + r[5] * pz + t[1];
    float z = r[6] * px + r[7] * py + r[8] * pz + t[2];
    Pixel pixel = Lens<kBend>(k, x, y, z);
    if (kRolls) {
      // To first order; the row hardly changes by it, so once is enough.
      const float rows = pixel.v - k.middle_row;
      const float sx = x + rows * (m[1] * z - m[2] * y + m[3]);
      const float sy = y + rows * (m[2] * x - m[0] * z + m[4]);
      const float sz = z + rows * (m[0] * y - m[1] * x + m[5]);
      x = sx;
      y = sy;
      z = sz;
      pixel = Lens<kBend>(k, x, y, z);
    }
    const float inverse = 1 / std::sqrt(x * x + y * y + z * z);
    // Not so for NaN, nor for a point in the camera's centre. As numbers: no branches.
    const float sees = (z * inverse >= k.min_cos_angle ? 1.0F : 0.0F) *
                       (inverse < kMost ? 1.0F : 0.0F) *
                       (std::fabs(pixel.u) + std::fabs(pixel.v) < kMost ? 1.0F : 0.0F);
    u[i] = sees > 0 ? pixel.u : 0.0F;
    v[i] = sees > 0 ? pixel.v : 0.0F;
    w[i] = sees > 0 ? inverse : 0.0F;
  }
}

}  // namespace

RGBDT_SIMD_DISPATCH
void ProjectKernel(const KernelProjection& projection, const float* points, std::size_t count,
                   const PixelArrays& out) {
  float* u = out.u;
  float* v = out.v;
  float* w = out.inverse_range;
  const float* d = projection.distortion;
  const bool rational = d[5] != 0 || d[6] != 0 || d[7] != 0;
  if (projection.fisheye) {
    projection.rolls ? Run<Bend::kFisheye, true>(projection, points, count, u, v, w)
                     : Run<Bend::kFisheye, false>(projection, points, count, u, v, w);
  } else if (rational) {
    projection.rolls ? Run<Bend::kRational, true>(projection, points, count, u, v, w)
                     : Run<Bend::kRational, false>(projection, points, count, u, v, w);
  } else {
    projection.rolls ? Run<Bend::kPolynomial, true>(projection, points, count, u, v, w)
                     : Run<Bend::kPolynomial, false>(projection, points, count, u, v, w);
  }
}

RGBDT_SIMD_DISPATCH
void FindBox(const float* points, std::size_t count, float* least, float* most) {
  // Coordinates as they lie, as many side by side as both threes and SIMD registers go into.
  constexpr std::size_t kSide = 48;
  float low[kSide], high[kSide];
  for (std::size_t j = 0; j < kSide; ++j) low[j] = high[j] = points[j % 3];
  std::size_t i = 0;
  for (; i + kSide <= 3 * count; i += kSide) {
    for (std::size_t j = 0; j < kSide; ++j) {
      const float value = points[i + j];
      low[j] = value < low[j] ? value : low[j];
      high[j] = value > high[j] ? value : high[j];
    }
  }
  for (; i < 3 * count; ++i) {
    low[i % 3] = points[i] < low[i % 3] ? points[i] : low[i % 3];
    high[i % 3] = points[i] > high[i % 3] ? points[i] : high[i % 3];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    least[k] = low[k];
    most[k] = high[k];
    for (std::size_t j = k + 3; j < kSide; j += 3) {
      least[k] = low[j] < least[k] ? low[j] : least[k];
      most[k] = high[j] > most[k] ? high[j] : most[k];
    }
  }
}

}  // namespace rgbdt
