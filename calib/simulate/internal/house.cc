#include "calib/simulate/internal/house.h"

#include <cmath>

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kWall = 0.3;    ///< thickness [m]
constexpr double kFloor = 2.95;  ///< height of a storey [m]

/// One house's measures [m].
struct Facade {
  double width = 8;
  int columns = 3, floors = 3;
  double window_width = 1.1, window_height = 1.4, sill = 0.95, recess = 0.18;
  int door_column = 0;
  Material wall, trim;

  double Left(int column) const { return (column + 0.5) * width / columns - 0.5 * window_width; }
  double Right(int column) const { return Left(column) + window_width; }
  double Top() const { return floors * kFloor; }
};

Material DrawWall(Dice* draw) {
  const double shade = draw->Between(0.75, 1.1);
  switch (draw->Below(3)) {
    case 0:
      return Paint(shade * Rgb(0.42, 0.18, 0.12), 0.4, 0, {Texture::Kind::kBricks, 0.3, 0.35});
    case 1:
      return Paint(shade * Rgb(0.60, 0.54, 0.40), 0.6, 0, {Texture::Kind::kBlotches, 0.5, 0.12});
    default:
      return Paint(shade * Rgb(0.48, 0.50, 0.52), 0.55, 0, {Texture::Kind::kTiles, 0.8, 0.14});
  }
}

Facade DrawFacade(Dice* draw, double width) {
  Facade f;
  f.width = width;
  f.columns = 2 + draw->Below(2);
  f.floors = 2 + draw->Below(2);
  f.window_width = draw->Between(0.95, 1.4);
  f.window_height = draw->Between(1.25, 1.6);
  f.recess = draw->Between(0.1, 0.25);
  f.door_column = draw->Below(f.columns);
  f.wall = DrawWall(draw);
  f.trim = Paint(Rgb(0.68, 0.66, 0.62), 0.65, 0);
  return f;
}

/// Walls between windows, storey by storey, so that the windows are holes.
void AddWalls(const Facade& f, Thing* house) {
  const auto wall = [&](double x0, double x1, double z0, double z1) {
    house->Add("wall", MakeBox({x0, 0, z0}, {x1, kWall, z1}), f.wall);
  };
  wall(0, f.Left(f.door_column), 0, f.sill);
  wall(f.Right(f.door_column), f.width, 0, f.sill);
  for (int floor = 0; floor < f.floors; ++floor) {
    const double low = floor * kFloor + f.sill;
    const double high = low + f.window_height;
    for (int column = 0; column <= f.columns; ++column) {
      wall(column == 0 ? 0 : f.Right(column - 1), column == f.columns ? f.width : f.Left(column),
           low, high);
    }
    wall(0, f.width, high, floor + 1 < f.floors ? low + kFloor : f.Top());
  }
  house->Add("house", MakeBox({0, kWall, -0.1}, {f.width, 8, f.Top()}), f.wall);
}

void AddWindow(const Facade& f, int column, double sill, Dice* draw, Thing* house) {
  const double x0 = f.Left(column), x1 = f.Right(column);
  const double z0 = sill, z1 = sill + f.window_height, y = f.recess;
  const Mesh pane = MakeQuad({x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1});
  if (draw->Chance(0.12)) {
    house->Add("shutter", pane,
               Paint(DrawPaint(draw), 0.45, 0, {Texture::Kind::kPlanks, 0.08, 0.4}));
    return;
  }
  const bool heated = draw->Chance(0.25);
  house->AddWarm("glass", pane, Glass(house->warmth().air_k + (heated ? 7 : -1)));
  const double middle = 0.5 * (x0 + x1);
  house->Add("frame", MakeBox({middle - 0.03, y - 0.04, z0}, {middle + 0.03, y - 0.005, z1}),
             f.trim);
  const double bar = z0 + 0.68 * f.window_height;
  house->Add("frame", MakeBox({x0, y - 0.04, bar - 0.025}, {x1, y - 0.005, bar + 0.025}), f.trim);
  house->Add("sill", MakeBox({x0 - 0.06, -0.07, z0 - 0.06}, {x1 + 0.06, y, z0}), f.trim);
}

void AddBalcony(const Facade& f, int column, double floor_z, Thing* house) {
  const double x0 = f.Left(column) - 0.35, x1 = f.Right(column) + 0.35, deep = 0.9;
  house->Add("balcony", MakeBox({x0, -deep, floor_z - 0.14}, {x1, 0, floor_z}), f.trim);
  const Material iron = Paint(Rgb(0.06, 0.06, 0.07), 0.25, 0);
  const double top = floor_z + 1;
  for (const double x : {x0 + 0.03, x1 - 0.03}) {
    house->Add("rail", MakeRod({x, -deep, top}, {x, 0, top}, 0.025, 0.025), iron);
  }
  house->Add("rail", MakeRod({x0, -deep + 0.03, top}, {x1, -deep + 0.03, top}, 0.025, 0.025), iron);
  constexpr int kBars = 10;
  for (int i = 0; i < kBars; ++i) {
    const double x = x0 + 0.03 + (x1 - x0 - 0.06) * i / (kBars - 1);
    house->Add("bar", MakeBox({x - 0.012, -deep + 0.02, floor_z}, {x + 0.012, -deep + 0.04, top}),
               iron);
  }
}

void AddDoor(const Facade& f, Dice* draw, Thing* house) {
  const double x0 = f.Left(f.door_column), x1 = f.Right(f.door_column);
  const double top = f.sill + f.window_height;
  const double y = f.recess + 0.04;
  house->Add("door", MakeBox({x0, y, 0}, {x1, kWall, top - 0.3}),
             Paint(DrawPaint(draw), 0.4, 0, {Texture::Kind::kPlanks, 0.2, 0.25}));
  house->AddWarm("glass",
                 MakeQuad({x0, y, top - 0.3}, {x1, y, top - 0.3}, {x1, y, top}, {x0, y, top}),
                 Glass(house->warmth().air_k));
  house->Add("step", MakeBox({x0 - 0.2, -0.35, 0}, {x1 + 0.2, 0.1, 0.15}), f.trim);
  house->Add("canopy", MakeBox({x0 - 0.25, -0.7, top + 0.1}, {x1 + 0.25, 0, top + 0.18}), f.trim);
}

void AddTrimmings(const Facade& f, Dice* draw, Thing* house) {
  house->Add("ledge", MakeBox({0, -0.12, kFloor - 0.1}, {f.width, 0, kFloor + 0.05}), f.trim);
  house->Add("eaves", MakeBox({0, -0.4, f.Top()}, {f.width, 8, f.Top() + 0.2}), f.trim);
  house->Add(
      "roof",
      MakeFrustum({0, -0.4}, {f.width, 8}, f.Top() + 0.2, {0, 3}, {f.width, 4.6}, f.Top() + 2.2),
      Paint(Rgb(0.30, 0.13, 0.09), 0.35, 0, {Texture::Kind::kBricks, 0.3, 0.3}));
  house->Add("pipe", MakeRod({0.15, -0.07, 0}, {0.15, -0.07, f.Top()}, 0.05, 0.05),
             Paint(Rgb(0.38, 0.39, 0.40), 0.4, 0));
  if (f.Left(0) < 0.9) return;
  const double width = std::min(0.7, f.Left(0) - 0.4);
  house->Add("poster", MakeBox({0.3, -0.002, 1}, {0.3 + width, 0, 1 + 1.4 * width}),
             Paint(DrawPaint(draw), 0.5, 0, {Texture::Kind::kTiles, 0.12, 0.8}));
}

}  // namespace

Thing MakeHouse(Dice* draw, const Warmth& warmth, double width_m) {
  const Facade f = DrawFacade(draw, width_m);
  Thing house(warmth);
  AddWalls(f, &house);
  AddDoor(f, draw, &house);
  for (int floor = 0; floor < f.floors; ++floor) {
    for (int column = 0; column < f.columns; ++column) {
      if (floor == 0 && column == f.door_column) continue;
      AddWindow(f, column, floor * kFloor + f.sill, draw, &house);
      if (floor > 0 && draw->Chance(0.3)) AddBalcony(f, column, floor * kFloor + 0.2, &house);
    }
  }
  AddTrimmings(f, draw, &house);
  return house;
}

}  // namespace rgbdt::simulate
