#include "calib/simulate/internal/walker.h"

#include <cmath>

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

/// A limb that hangs from a joint and is bent once; angles from straight down, forwards [rad].
void AddLimb(const Vector3d& joint, double upper_m, double upper_rad, double lower_m,
             double lower_rad, double thick_m, const Material& upper, const Material& lower,
             Thing* person, Vector3d* end) {
  const Vector3d bend = joint + upper_m * Vector3d(std::sin(upper_rad), 0, -std::cos(upper_rad));
  *end = bend + lower_m * Vector3d(std::sin(lower_rad), 0, -std::cos(lower_rad));
  person->AddWarm("limb", MakeRod(joint, bend, thick_m, 0.8 * thick_m), upper);
  person->AddWarm("limb", MakeRod(bend, *end, 0.78 * thick_m, 0.6 * thick_m), lower);
}

}  // namespace

Thing MakeWalker(Dice* draw, double temperature_k) {
  Thing person(Warmth{});
  const double size = draw->Between(0.92, 1.06);
  const Material skin = Paint(Rgb(0.52, 0.33, 0.24), 0.5, temperature_k + 1);
  const Material shirt = Paint(DrawPaint(draw), 0.45, temperature_k);
  const Material trousers = Paint(0.6 * DrawPaint(draw), 0.35, temperature_k - 0.8);
  const Material hair = Paint(Rgb(0.06, 0.045, 0.03), 0.2, temperature_k - 1.5);
  const double stride = draw->Between(-0.5, 0.5);
  Vector3d end;
  for (const double side : {-1.0, 1.0}) {
    const double swing = side * stride;
    AddLimb(size * Vector3d(0, side * 0.09, 0.9), 0.43 * size, swing, 0.4 * size,
            swing - std::max(0.0, -swing) * 0.8, 0.088 * size, trousers, trousers, &person, &end);
    person.AddWarm("shoe", MakeEllipsoid(end + Vector3d(0.06, 0, 0), {0.14, 0.05, 0.05}), hair);
    AddLimb(size * Vector3d(0, side * 0.23, 1.42), 0.3 * size, -swing, 0.27 * size,
            -swing + draw->Between(0.1, 1.2), 0.052 * size, shirt, skin, &person, &end);
    person.AddWarm("hand", MakeEllipsoid(end, {0.045, 0.035, 0.05}), skin);
  }
  const auto round = [&](const char* name, double x, double z, const Vector3d& radii,
                         const Material& material) {
    person.AddWarm(name, MakeEllipsoid(size * Vector3d(x, 0, z), size * radii), material);
  };
  round("torso", 0, 1.18, {0.14, 0.22, 0.36}, shirt);
  round("head", 0.01, 1.66, {0.095, 0.08, 0.12}, skin);
  round("hair", -0.02, 1.70, {0.095, 0.085, 0.10}, hair);
  person.AddWarm(
      "neck", MakeRod(size * Vector3d(0, 0, 1.45), size * Vector3d(0, 0, 1.6), 0.055, 0.055), skin);
  return person;
}

}  // namespace rgbdt::simulate
