#include "calib/simulate/internal/furniture.h"

#include "calib/simulate/internal/foliage.h"

namespace rgbdt::simulate {
namespace {

Material Wood(Dice* draw) {
  const double shade = draw->Between(0.5, 1.2);
  return Paint(shade * Rgb(0.50, 0.35, 0.20), 0.5, 0, {Texture::Kind::kPlanks, 0.12, 0.25});
}

Material Metal() { return Paint(Rgb(0.22, 0.22, 0.24), 0.3, 0); }
Material Card() { return Paint(Rgb(0.56, 0.42, 0.27), 0.55, 0); }

void AddLegs(double half_x, double half_y, double top, const Material& material, Thing* thing) {
  for (const double x : {0.04 - half_x, half_x - 0.04}) {
    for (const double y : {0.04 - half_y, half_y - 0.04}) {
      thing->Add("leg", MakeBox({x - 0.022, y - 0.022, 0}, {x + 0.022, y + 0.022, top}), material);
    }
  }
}

/// Looks to -x, its foot at (x, y) on a table.
void AddScreen(double x, double y, double table, Dice* draw, Thing* thing) {
  Material front = Paint(Rgb(0.03, 0.05, 0.08), 0.08, thing->warmth().air_k + draw->Between(5, 11));
  const double width = draw->Between(0.24, 0.33);
  thing->AddWarm("screen",
                 MakeBox({x - 0.02, y - width, table + 0.12}, {x + 0.02, y + width, table + 0.5}),
                 front);
  thing->Add("screen foot",
             MakeBox({x + 0.005, y - 0.03, table + 0.01}, {x + 0.035, y + 0.03, table + 0.2}),
             Metal());
  thing->Add("screen foot",
             MakeBox({x - 0.09, y - 0.11, table}, {x + 0.09, y + 0.11, table + 0.012}), Metal());
}

/// Books or boxes side by side on a board from y0 to y1.
void AddRow(double y0, double y1, double z, double high, double half_x, Dice* draw, Thing* thing) {
  for (double y = y0 + draw->Between(0.01, 0.1); y < y1 - 0.1;) {
    const bool box = draw->Chance(0.25);
    const double width = box ? draw->Between(0.15, 0.3) : draw->Between(0.025, 0.07);
    if (y + width > y1) break;
    const double front = -half_x + draw->Between(0.01, 0.1);
    const double top = z + high * draw->Between(0.55, 0.9);
    thing->Add(box ? "box" : "book", MakeBox({front, y, z}, {half_x - 0.03, y + width, top}),
               box ? Card() : Paint(DrawPaint(draw), 0.45, 0));
    y += width + (draw->Chance(0.12) ? draw->Between(0.1, 0.3) : 0.003);
  }
}

}  // namespace

Furniture MakeTableWithThings(Dice* draw, const Warmth& warmth, double leaves) {
  Furniture f{Thing(warmth), draw->Between(0.38, 0.5), draw->Between(0.6, 0.95)};
  const double top = draw->Between(0.7, 0.78);
  f.thing.Add("table top", MakeBox({-f.half_x, -f.half_y, top - 0.03}, {f.half_x, f.half_y, top}),
              Wood(draw));
  AddLegs(f.half_x, f.half_y, top - 0.03, Metal(), &f.thing);
  if (draw->Chance(0.7)) AddScreen(0.1, -0.3 * f.half_y, top, draw, &f.thing);
  if (draw->Chance(0.7)) {
    const double y = 0.45 * f.half_y, half = draw->Between(0.1, 0.18);
    f.thing.Add("box", MakeBox({-half, y - half, top}, {half, y + half, top + 1.4 * half}), Card());
  }
  if (draw->Chance(0.5)) {
    f.thing.AddAll(Standing(0.15, 0.8 * f.half_y, top, 0),
                   MakeBush(draw, {warmth.air_k, 0}, draw->Between(0.3, 0.5), 0.25 * leaves));
  }
  const double tea_k = warmth.air_k + draw->Between(0, 25);
  f.thing.AddWarm(
      "mug", MakeRod({-0.2, -0.7 * f.half_y, top}, {-0.2, -0.7 * f.half_y, top + 0.1}, 0.04, 0.042),
      Paint(DrawPaint(draw), 0.6, tea_k));
  return f;
}

Furniture MakeChair(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), 0.24, 0.23};
  const Material seat = Paint(DrawPaint(draw), 0.4, 0);
  f.thing.Add("seat", MakeBox({-0.22, -0.21, 0.43}, {0.22, 0.21, 0.47}), seat);
  f.thing.Add("back", MakeBox({0.19, -0.2, 0.62}, {0.22, 0.2, 0.92}), seat);
  AddLegs(0.24, 0.23, 0.43, Metal(), &f.thing);
  for (const double y : {-0.19, 0.19}) {
    f.thing.Add("leg", MakeBox({0.2, y - 0.02, 0.47}, {0.23, y + 0.02, 0.9}), Metal());
  }
  return f;
}

Furniture MakeSofa(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), 0.45, draw->Between(0.8, 1.1)};
  const Material cloth = Paint(DrawPaint(draw), 0.4, 0, {Texture::Kind::kBlotches, 0.05, 0.2});
  const double y = f.half_y;
  f.thing.Add("sofa", MakeBox({-0.45, 0.16 - y, 0.1}, {0.25, y - 0.16, 0.42}), cloth);
  f.thing.Add("sofa", MakeFrustum({0.15, -y}, {0.45, y}, 0.1, {0.3, -y}, {0.45, y}, 0.85), cloth);
  for (const double side : {-1.0, 1.0}) {
    f.thing.Add(
        "sofa",
        MakeBox({-0.45, side * (y - 0.08) - 0.08, 0.05}, {0.3, side * (y - 0.08) + 0.08, 0.6}),
        cloth);
    f.thing.Add("cushion", MakeEllipsoid({0.05, 0.5 * side * y, 0.58}, {0.1, 0.22, 0.18}),
                Paint(DrawPaint(draw), 0.5, 0));
  }
  return f;
}

Furniture MakeShelf(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), draw->Between(0.15, 0.2), draw->Between(0.4, 0.9)};
  const Material wood = Wood(draw);
  const int boards = 4 + draw->Below(2);
  const double pitch = draw->Between(0.34, 0.42), top = pitch * (boards - 1) + 0.1;
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (f.half_y - 0.01);
    f.thing.Add("shelf side", MakeBox({-f.half_x, y - 0.01, 0}, {f.half_x, y + 0.01, top}), wood);
  }
  for (int i = 0; i < boards; ++i) {
    const double z = 0.08 + pitch * i;
    f.thing.Add("shelf",
                MakeBox({-f.half_x, 0.02 - f.half_y, z - 0.02}, {f.half_x, f.half_y - 0.02, z}),
                wood);
    if (i + 1 < boards)
      AddRow(0.03 - f.half_y, f.half_y - 0.03, z, pitch, f.half_x, draw, &f.thing);
  }
  return f;
}

Furniture MakeCupboard(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), draw->Between(0.25, 0.32), draw->Between(0.4, 0.65)};
  const double top = draw->Between(1.0, 2.1);
  const Material wood = draw->Chance(0.5) ? Wood(draw) : Paint(Rgb(0.6, 0.62, 0.6), 0.6, 0);
  f.thing.Add("cupboard", MakeBox({-f.half_x, -f.half_y, 0}, {f.half_x, f.half_y, top}), wood);
  for (const double side : {-1.0, 1.0}) {
    const double y = 0.5 * side * f.half_y;
    f.thing.Add("cupboard door",
                MakeBox({-f.half_x - 0.018, y - 0.47 * f.half_y, 0.08},
                        {-f.half_x, y + 0.47 * f.half_y, top - 0.04}),
                wood);
    f.thing.Add("handle",
                MakeRod({-f.half_x - 0.05, side * 0.06, 0.5 * top},
                        {-f.half_x - 0.05, side * 0.06, 0.5 * top + 0.15}, 0.008, 0.008),
                Metal());
  }
  return f;
}

Furniture MakeRadiator(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), 0.08, draw->Between(0.4, 0.7)};
  const Material warm = Paint(Rgb(0.68, 0.68, 0.66), 0.7, warmth.air_k + draw->Between(8, 25));
  constexpr int kRibs = 12;
  for (int i = 0; i < kRibs; ++i) {
    const double y = -f.half_y + 2 * f.half_y * (i + 0.5) / kRibs;
    const double half = 0.36 * f.half_y / kRibs * 2;
    f.thing.AddWarm("radiator", MakeBox({-0.06, y - half, 0.15}, {0.04, y + half, 0.75}), warm);
  }
  for (const double z : {0.2, 0.7}) {
    f.thing.AddWarm("radiator", MakeRod({0, -f.half_y, z}, {0, f.half_y, z}, 0.02, 0.02), warm);
  }
  return f;
}

Furniture MakePottedPlant(Dice* draw, const Warmth& warmth, double leaves) {
  Furniture f{Thing(warmth), 0.4, 0.4};
  f.thing.Add("pot", MakeRod({0, 0, 0}, {0, 0, 0.35}, 0.15, 0.19), Paint(DrawPaint(draw), 0.45, 0));
  f.thing.AddAll(Standing(0, 0, 0.32, 0),
                 MakeBush(draw, {warmth.air_k, 0}, draw->Between(0.7, 1.05), 0.4 * leaves));
  return f;
}

Furniture MakeBoxes(Dice* draw, const Warmth& warmth) {
  Furniture f{Thing(warmth), 0.32, 0.32};
  double z = 0;
  const int count = 1 + draw->Below(3);
  for (int i = 0; i < count; ++i) {
    const double half = draw->Between(0.15, 0.3), high = draw->Between(0.2, 0.4);
    f.thing.Add("box", MakeBox({-half, -half, z}, {half, half, z + high}),
                draw->Chance(0.6) ? Card() : Paint(DrawPaint(draw), 0.5, 0));
    z += high;
  }
  return f;
}

Furniture MakeFloorLamp(const Warmth& warmth) {
  Furniture f{Thing(warmth), 0.22, 0.22};
  f.thing.Add("lamp foot", MakeRod({0, 0, 0}, {0, 0, 0.03}, 0.16, 0.15), Metal());
  f.thing.Add("lamp pole", MakeRod({0, 0, 0}, {0, 0, 1.5}, 0.015, 0.015), Metal());
  f.thing.AddWarm("lamp shade", MakeRod({0, 0, 1.4}, {0, 0, 1.68}, 0.21, 0.13),
                  Paint(Rgb(0.75, 0.68, 0.5), 0.6, warmth.air_k + 9));
  return f;
}

}  // namespace rgbdt::simulate
