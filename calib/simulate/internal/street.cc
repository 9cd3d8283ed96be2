#include "calib/simulate/internal/street.h"

#include <cmath>

#include "calib/simulate/internal/foliage.h"
#include "calib/simulate/internal/house.h"
#include "calib/simulate/internal/street_things.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kCell = 8;           ///< along the street [m]
constexpr double kStreetBehind = 20;  ///< how far back the street is made [m]
constexpr double kStreetAhead = 62;   ///< beyond what a LIDAR's beam comes back from
constexpr double kKerb = 4.5;         ///< from the middle of the street [m]
constexpr double kPaint = 0.003;      ///< markings lie so much above the road [m]

/// One of the two sides, in a frame of its own: x along it from the cell's start, y away from the
/// street's middle, z from the ground.
struct Side {
  Rigid3 world_from_side;
  double facade = 7;  ///< y of the facades
  double leaves = 1;
  Warmth warmth;
  Thing* street;

  void Put(const Rigid3& place, const Thing& thing) const {
    street->AddAll(world_from_side * place, thing);
  }
};

void AddGarden(const Side& side, Dice* draw) {
  Thing garden(side.warmth);
  const double y = side.facade;
  garden.Add("lawn", MakeBox({0, y, -0.1}, {kCell, y + 14, 0.13}),
             Paint(Rgb(0.13, 0.20, 0.06), 0.45, 0, {Texture::Kind::kBlotches, 0.35, 0.5, 0.8}));
  if (draw->Chance(0.5)) {
    const double top = draw->Between(1.1, 1.8);
    const Mesh hedge = MakeHedge(draw, {0.1, y + 0.1, 0.1}, {kCell - 0.1, y + 0.7, top},
                                 static_cast<int>(900 * side.leaves) + 1, 0.17);
    garden.AddWarm("hedge", hedge, LeafMaterial(draw, side.warmth));
    garden.Add("hedge core", MakeBox({0.1, y + 0.3, 0.1}, {kCell - 0.1, y + 0.5, top - 0.15}),
               Paint(Rgb(0.03, 0.05, 0.02), 0.2, 0));
  } else {
    garden.AddAll(Standing(0, y + 0.2, 0.1, 0), MakeFence(side.warmth, kCell));
  }
  const double height = draw->Between(4.5, 7);
  const Thing tree = MakeTree(draw, side.warmth, height, 1.2 * side.leaves);
  const double tree_x = draw->Between(2.5, 5.5);
  garden.AddAll(Standing(tree_x, y + draw->Between(2.8, 4.5), 0.1, 0), tree);
  for (int i = 0; i < 2; ++i) {
    const Thing bush = MakeBush(draw, side.warmth, draw->Between(0.9, 1.6), side.leaves);
    garden.AddAll(Standing(draw->Between(0.8 + 4 * i, 3 + 4 * i), y + 1.7, 0.1, 0), bush);
  }
  side.Put({}, garden);
}

/// The pavement's furniture and what is parked and left at the kerb.
void AddKerbside(const Side& side, int cell, Dice* draw) {
  if (draw->Chance(0.55)) {
    const double x = draw->Between(2.2, 5.8);
    const double turn = draw->Chance(0.5) ? 0 : M_PI;
    const Thing car = MakeCar(draw, side.warmth);
    side.Put(Standing(x, 3.4 + draw->Between(-0.06, 0.06), 0, turn), car);
  }
  // Near the rig's way, where what is seen tells translation.
  const int things = draw->Below(3);
  for (int i = 0; i < things; ++i) {
    const double x = draw->Between(0.6 + 4 * i, 3.4 + 4 * i);
    const double turn = draw->Between(-0.15, 0.15);
    const Thing thing = MakeKerbThing(draw, side.warmth, side.leaves);
    side.Put(Standing(x, draw->Between(1.8, 1.86), 0, turn), thing);
  }
  if (draw->Chance(0.35)) {
    const Thing tree = MakeTree(draw, side.warmth, draw->Between(4.6, 5.4), side.leaves);
    side.Put(Standing(draw->Between(1.5, 6.5), kKerb + 0.75, 0.1, 0), tree);
  }
  if (cell % 2 == 0) side.Put(Standing(0.4, kKerb + 0.3, 0, 0), MakeLampPost(side.warmth, -1.2));
  if (draw->Chance(0.4)) {
    const bool right = side.world_from_side.rotation.w() < 0.5;
    side.Put(Standing(7.3, kKerb + 0.3, 0, right ? M_PI : 0), MakeSign(draw, side.warmth));
  }
}

void AddSideOfCell(Side side, int cell, Dice* draw) {
  side.warmth.air_k += draw->Between(-1.5, 1.5);
  if (draw->Chance(0.68)) {
    const double width = draw->Chance(0.6) ? kCell : kCell - 1.5;
    side.Put(Standing(0, side.facade, 0, 0), MakeHouse(draw, side.warmth, width));
  } else {
    AddGarden(side, draw);
  }
  AddKerbside(side, cell, draw);
}

Mesh Patch(double x0, double x1, double y0, double y1, double z) {
  return MakeQuad({x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z});
}

/// Paint, repairs and warm places: edges in an image that are none in range.
void AddMarkings(double x, double ground, Dice* draw, Thing* street) {
  const double z = ground + kPaint;
  const Material white = Paint(Rgb(0.66, 0.66, 0.64), 0.7, 0, {Texture::Kind::kBlotches, 0.1, 0.2});
  const auto paint = [&](double x0, double x1, double y0, double y1) {
    street->Add("marking", Patch(x + x0, x + x1, y0, y1, z), white);
  };
  if (draw->Chance(0.2)) {
    for (double y = -3.6; y < 3.5; y += 1) paint(2, 5, y, y + 0.5);
  } else {
    paint(0.5, 3, -0.07, 0.07);
    paint(4.5, 7, -0.07, 0.07);
  }
  for (const double side : {-1.0, 1.0}) paint(0, kCell, side * 2.28 - 0.06, side * 2.28 + 0.06);
  for (int i = 0; i < 2; ++i) {
    const double x0 = x + draw->Between(0, 5), y0 = draw->Between(-4, 2);
    const double length = draw->Between(0.8, 2.5), width = draw->Between(0.6, 1.8);
    const double slant = draw->Between(-0.4, 0.4);
    const double lift = ground + 0.001 + 0.0004 * i;
    Material patch = Paint(Rgb(0.13, 0.13, 0.135), 0.22, 0, {Texture::Kind::kBlotches, 0.15, 0.2});
    patch = Warmed(patch, street->warmth());
    patch.temperature_k += draw->Between(-3, 6);  // a manhole's warmth, or a puddle that dries
    street->AddWarm(
        "warm patch",
        MakeQuad({x0, y0, lift}, {x0 + length, y0 + slant, lift},
                 {x0 + length - slant, y0 + width, lift}, {x0 - slant, y0 + width, lift}),
        patch);
  }
  street->Add("manhole", MakeRod({x + 3.7, -0.8, z - 0.002}, {x + 3.7, -0.8, z}, 0.32, 0.32),
              Paint(Rgb(0.09, 0.09, 0.09), 0.3, 0));
}

void AddGround(const Options& options, double x, Thing* street) {
  const double z = options.world.ground_z_m;
  street->Add("road", Patch(x - 80, x + 200, -kKerb, kKerb, z),
              Paint(Rgb(0.17, 0.17, 0.175), 0.22, 0, {Texture::Kind::kBlotches, 0.12, 0.25, 0.3}));
  street->Add("meadow", Patch(x - 80, x + 200, -90, 90, z - 0.05),
              Paint(Rgb(0.14, 0.19, 0.07), 0.45, 0, {Texture::Kind::kBlotches, 0.5, 0.5, 0.8}));
  for (const double side : {-1.0, 1.0}) {
    const double inner = side * kKerb, outer = side * 9.5;
    street->Add("pavement",
                MakeBox({x - 80, std::min(inner, outer), z - 0.1},
                        {x + 200, std::max(inner, outer), z + 0.1}),
                Paint(Rgb(0.34, 0.33, 0.31), 0.35, 0, {Texture::Kind::kTiles, 0.5, 0.2}));
  }
}

}  // namespace

Thing MakeStreet(const Options& options, const Warmth& warmth, double x_m) {
  Thing street(warmth);
  const double ground = options.world.ground_z_m;
  AddGround(options, kCell * std::floor(x_m / kCell), &street);
  Dice place(options.seed, 0, "street");
  const double facade[2] = {place.Between(6.9, 8.4), place.Between(6.9, 8.4)};
  const int first = static_cast<int>(std::floor((x_m - kStreetBehind) / kCell));
  const int last = static_cast<int>(std::floor((x_m + kStreetAhead) / kCell));
  for (int cell = first; cell <= last; ++cell) {
    const double x = kCell * cell;
    Dice road(options.seed, cell, "street road");
    AddMarkings(x, ground, &road, &street);
    for (const bool left : {false, true}) {
      Dice draw(options.seed, cell, left ? "street left" : "street right");
      const Rigid3 place_of_side =
          left ? Standing(x, 0, ground, 0) : Standing(x + kCell, 0, ground, M_PI);
      AddSideOfCell({place_of_side, facade[left ? 1 : 0], options.natural.leaves, warmth, &street},
                    cell, &draw);
    }
  }
  return street;
}

}  // namespace rgbdt::simulate
