#include "calib/simulate/internal/street_things.h"

#include "calib/simulate/internal/foliage.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

Material Iron() { return Paint(Rgb(0.20, 0.21, 0.22), 0.35, 0); }
Material White() { return Paint(Rgb(0.72, 0.72, 0.70), 0.75, 0); }
Material Red() { return Paint(Rgb(0.60, 0.05, 0.04), 0.6, 0); }

/// Panes on the slanted faces of the cabin, a little outside of it.
void AddCarWindows(const Mesh& cabin, Thing* car) {
  // Faces of MakeBox that are neither bottom nor top, each by its corners.
  const unsigned faces[4][4] = {{0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  Vector3d centre(0, 0, 0);
  for (const Vector3d& v : cabin.vertices) centre += v / 8;
  for (const auto& face : faces) {
    Vector3d middle(0, 0, 0);
    for (const unsigned i : face) middle += cabin.vertices[i] / 4;
    Vector3d out = middle - centre;
    out.z() = 0;
    const Vector3d shift = 0.012 * out.normalized() + Vector3d(0, 0, 0.006);
    Vector3d corner[4];
    for (int i = 0; i < 4; ++i) {
      corner[i] = middle + 0.88 * (cabin.vertices[face[i]] - middle) + shift;
    }
    car->AddWarm("car window", MakeQuad(corner[0], corner[1], corner[2], corner[3]),
                 Glass(car->warmth().air_k));
  }
}

void AddWheels(Thing* car) {
  const Material rubber = Paint(Rgb(0.025, 0.025, 0.025), 0.07, 0);
  for (const double x : {-1.3, 1.3}) {
    for (const double side : {-1.0, 1.0}) {
      const double y = side * 0.86;
      car->Add("wheel", MakeRod({x, y - 0.1, 0.31}, {x, y + 0.1, 0.31}, 0.31, 0.31), rubber);
      car->Add("rim", MakeRod({x, y + side * 0.09, 0.31}, {x, y + side * 0.115, 0.31}, 0.2, 0.17),
               Paint(Rgb(0.5, 0.5, 0.52), 0.5, 0));
    }
  }
}

void AddBarrier(Thing* thing) {
  for (const double y : {-0.42, 0.42}) {
    thing->Add("barrier foot", MakeBox({-0.25, y - 0.05, 0}, {0.25, y + 0.05, 0.08}), Iron());
    thing->Add("barrier post", MakeBox({-0.02, y - 0.02, 0}, {0.02, y + 0.02, 1}), Iron());
  }
  for (int i = 0; i < 5; ++i) {
    const double y = -0.5 + 0.2 * i;
    thing->Add("barrier board", MakeBox({-0.035, y, 0.75}, {-0.02, y + 0.2, 0.98}),
               i % 2 == 0 ? Red() : White());
  }
}

void AddPlanter(Dice* draw, double leaves, Thing* thing) {
  thing->Add("planter", MakeFrustum({-0.3, -0.3}, {0.3, 0.3}, 0, {-0.38, -0.38}, {0.38, 0.38}, 0.5),
             Paint(Rgb(0.45, 0.25, 0.17), 0.45, 0));
  thing->AddAll(Standing(0, 0, 0.45, 0),
                MakeBush(draw, thing->warmth(), draw->Between(0.6, 1.0), leaves));
}

void AddCrates(Dice* draw, Thing* thing) {
  double z = 0;
  const int count = 1 + draw->Below(3);
  for (int i = 0; i < count; ++i) {
    const double half = draw->Between(0.2, 0.32), height = draw->Between(0.25, 0.5);
    const double x = draw->Between(-0.05, 0.05);
    thing->Add("crate", MakeBox({x - half, x - half, z}, {x + half, x + half, z + height}),
               Paint(Rgb(0.52, 0.38, 0.20), 0.5, 0, {Texture::Kind::kPlanks, 0.1, 0.35}));
    z += height;
  }
}

}  // namespace

Thing MakeCar(Dice* draw, const Warmth& warmth) {
  Thing car(warmth);
  const Vector3d hue = DrawPaint(draw);
  const Material paint = Paint(hue, draw->Between(0.2, 0.6), 0);
  const double roof = draw->Between(1.38, 1.6);
  car.Add("car body",
          MakeFrustum({-2.05, -0.84}, {2.05, 0.84}, 0.22, {-2.1, -0.87}, {2.1, 0.87}, 0.6), paint);
  car.Add("car body", MakeFrustum({-2.1, -0.87}, {2.1, 0.87}, 0.6, {-2.0, -0.8}, {1.95, 0.8}, 0.88),
          paint);
  const Mesh cabin =
      MakeFrustum({-1.85, -0.79}, {1.0, 0.79}, 0.88, {-1.45, -0.62}, {0.3, 0.62}, roof);
  car.Add("car cabin", cabin, paint);
  AddCarWindows(cabin, &car);
  AddWheels(&car);
  for (const double end : {-1.0, 1.0}) {
    car.Add("bumper", MakeBox({end * 2.12 - 0.06, -0.8, 0.3}, {end * 2.12 + 0.06, 0.8, 0.45}),
            Iron());
    for (const double y : {-0.68, 0.68}) {
      car.Add("lamp",
              MakeBox({end * 2.09 - 0.02, y - 0.14, 0.6}, {end * 2.09 + 0.02, y + 0.14, 0.74}),
              end > 0 ? White() : Red());
    }
    car.Add("number plate",
            MakeBox({end * 2.18 - 0.004, -0.26, 0.33}, {end * 2.18 + 0.004, 0.26, 0.44}), White());
  }
  if (draw->Chance(0.5)) {
    Material bonnet = Warmed(paint, warmth);
    bonnet.temperature_k += draw->Between(8, 22);
    car.AddWarm(
        "warm bonnet",
        MakeQuad({1.1, -0.7, 0.882}, {1.9, -0.7, 0.882}, {1.9, 0.7, 0.882}, {1.1, 0.7, 0.882}),
        bonnet);
  }
  return car;
}

Thing MakeLampPost(const Warmth& warmth, double arm_towards_y) {
  Thing post(warmth);
  post.Add("lamp post", MakeRod({0, 0, 0}, {0, 0, 0.9}, 0.1, 0.09), Iron());
  post.Add("lamp post", MakeRod({0, 0, 0.9}, {0, 0, 5.2}, 0.065, 0.045), Iron());
  post.Add("lamp arm", MakeRod({0, 0, 5.15}, {0, arm_towards_y, 5.4}, 0.035, 0.03), Iron());
  post.Add("lamp head", MakeEllipsoid({0, arm_towards_y, 5.36}, {0.16, 0.3, 0.08}), White());
  return post;
}

Thing MakeSign(Dice* draw, const Warmth& warmth) {
  Thing sign(warmth);
  const double top = draw->Between(2.0, 2.5);
  sign.Add("sign post", MakeRod({0, 0, 0}, {0, 0, top + 0.3}, 0.03, 0.03), Iron());
  if (draw->Chance(0.5)) {
    sign.Add("sign", MakeRod({-0.05, 0, top}, {-0.035, 0, top}, 0.3, 0.3), Red());
    sign.Add("sign", MakeRod({-0.052, 0, top}, {-0.05, 0, top}, 0.23, 0.23), White());
  } else {
    sign.Add("sign", MakeBox({-0.05, -0.35, top - 0.25}, {-0.035, 0.35, top + 0.25}),
             Paint(Rgb(0.05, 0.13, 0.5), 0.5, 0));
    sign.Add("sign", MakeBox({-0.052, -0.28, top - 0.05}, {-0.05, 0.28, top + 0.05}), White());
  }
  return sign;
}

Thing MakeFence(const Warmth& warmth, double length_m) {
  Thing fence(warmth);
  const Material wood = Paint(Rgb(0.46, 0.33, 0.20), 0.5, 0, {Texture::Kind::kBlotches, 0.1, 0.3});
  for (const double z : {0.35, 0.9}) {
    fence.Add("fence", MakeBox({0, 0.02, z - 0.04}, {length_m, 0.06, z + 0.04}), wood);
  }
  const int pickets = static_cast<int>(length_m / 0.24);
  for (int i = 0; i < pickets; ++i) {
    const double x = (i + 0.5) * length_m / pickets;
    fence.Add("picket", MakeBox({x - 0.05, 0, 0.06}, {x + 0.05, 0.02, 1.15}), wood);
  }
  return fence;
}

Thing MakeKerbThing(Dice* draw, const Warmth& warmth, double leaves) {
  Thing thing(warmth);
  switch (draw->Below(6)) {
    case 0:
      thing.Add("bollard", MakeRod({0, 0, 0}, {0, 0, 0.85}, 0.08, 0.07), Iron());
      thing.Add("bollard", MakeRod({0, 0, 0.66}, {0, 0, 0.76}, 0.082, 0.08), White());
      break;
    case 1:
      thing.Add("bin", MakeRod({0, 0, 0}, {0, 0, 0.95}, 0.24, 0.28),
                Paint(DrawPaint(draw), 0.35, 0));
      thing.Add("bin lid", MakeEllipsoid({0, 0, 0.95}, {0.3, 0.3, 0.1}), Iron());
      break;
    case 2:
      thing.Add("cone foot", MakeBox({-0.2, -0.2, 0}, {0.2, 0.2, 0.04}), Iron());
      thing.Add("cone", MakeRod({0, 0, 0.04}, {0, 0, 0.75}, 0.15, 0.03), Red());
      thing.Add("cone", MakeRod({0, 0, 0.35}, {0, 0, 0.5}, 0.101, 0.075), White());
      break;
    case 3:
      AddCrates(draw, &thing);
      break;
    case 4:
      AddPlanter(draw, leaves, &thing);
      break;
    default:
      AddBarrier(&thing);
      break;
  }
  return thing;
}

}  // namespace rgbdt::simulate
