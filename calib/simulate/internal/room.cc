#include "calib/simulate/internal/room.h"

#include <cmath>
#include <functional>

#include "calib/simulate/internal/furniture.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The room from wall to wall, and what of its floor is taken.
struct Plan {
  Vector2d low, high;
  double floor = -1.2, ceiling = 1.6;  ///< z [m]
  struct Rectangle {
    Vector2d low, high;
  };
  std::vector<Rectangle> taken;

  bool Take(const Vector2d& a, const Vector2d& b) {
    constexpr double kGap = 0.05;
    for (const Rectangle& r : taken) {
      if (((a.array() - kGap) < r.high.array()).all() && ((r.low.array() - kGap) < b.array()).all())
        return false;
    }
    taken.push_back({a, b});
    return true;
  }
};

/// A wall: x along it from its middle, y out of the room, z from the floor.
struct RoomWall {
  Rigid3 world_from_wall;
  double length;
};

std::vector<RoomWall> WallsOf(const Plan& plan) {
  const Vector2d middle = 0.5 * (plan.low + plan.high), size = plan.high - plan.low;
  return {{Standing(plan.high.x(), middle.y(), plan.floor, -M_PI / 2), size.y()},
          {Standing(middle.x(), plan.high.y(), plan.floor, 0), size.x()},
          {Standing(middle.x(), plan.low.y(), plan.floor, M_PI), size.x()},
          {Standing(plan.low.x(), middle.y(), plan.floor, M_PI / 2), size.y()}};
}

Plan DrawPlan(const Options& options, Dice* draw) {
  Plan plan;
  plan.low = {draw->Between(-4.2, -3), draw->Between(-4.6, -3)};
  plan.high = {draw->Between(5.2, 8.5), draw->Between(3, 4.6)};
  plan.floor = options.world.ground_z_m;
  plan.ceiling = plan.floor + draw->Between(2.6, 3.3);
  const double free = kRoomFree + 0.35;
  plan.taken.push_back({{-free, -free}, {free + 0.3, free}});
  if (options.natural.board) plan.taken.push_back({{free, -1.2}, {4.4, 1.2}});
  return plan;
}

void AddShell(const Plan& plan, Dice* draw, Thing* room) {
  const auto level = [&](double z) {
    return MakeQuad({plan.low.x(), plan.low.y(), z}, {plan.high.x(), plan.low.y(), z},
                    {plan.high.x(), plan.high.y(), z}, {plan.low.x(), plan.high.y(), z});
  };
  const Texture floor = draw->Chance(0.5) ? Texture{Texture::Kind::kTiles, 0.4, 0.2}
                                          : Texture{Texture::Kind::kPlanks, 0.14, 0.35};
  room->Add("floor", level(plan.floor), Paint(Rgb(0.40, 0.32, 0.24), 0.4, 0, floor));
  room->Add("ceiling", level(plan.ceiling), Paint(Rgb(0.72, 0.72, 0.70), 0.75, 0));
  const Vector3d tint{draw->Between(0.42, 0.66), draw->Between(0.48, 0.66),
                      draw->Between(0.5, 0.68)};
  const double height = plan.ceiling - plan.floor;
  for (const RoomWall& wall : WallsOf(plan)) {
    const double half = 0.5 * wall.length;
    Thing sheet({room->warmth().air_k + draw->Between(-1, 0.5), 0});
    sheet.Add(
        "wall", MakeQuad({-half, 0, 0}, {half, 0, 0}, {half, 0, height}, {-half, 0, height}),
        Paint(tint * draw->Between(0.9, 1.05), 0.65, 0, {Texture::Kind::kBlotches, 0.9, 0.05}));
    sheet.Add("skirting", MakeBox({-half, -0.015, 0}, {half, 0, 0.09}),
              Paint(Rgb(0.6, 0.58, 0.52), 0.6, 0));
    room->AddAll(wall.world_from_wall, sheet);
  }
}

/// A frame of four bars round a pane.
void AddWindow(double x, double width, Dice* draw, Thing* on_wall) {
  const double low = 0.95, high = 2.2, half = 0.5 * width;
  on_wall->AddWarm("glass",
                   MakeQuad({x - half, -0.01, low}, {x + half, -0.01, low}, {x + half, -0.01, high},
                            {x - half, -0.01, high}),
                   Glass(on_wall->warmth().air_k - draw->Between(2, 6)));
  const Material frame = Paint(Rgb(0.7, 0.7, 0.68), 0.7, 0);
  for (const double edge : {x - half, x, x + half}) {
    on_wall->Add("frame", MakeBox({edge - 0.04, -0.06, low}, {edge + 0.04, 0, high}), frame);
  }
  for (const double z : {low, high}) {
    on_wall->Add("frame",
                 MakeBox({x - half - 0.04, -0.07, z - 0.04}, {x + half + 0.04, 0, z + 0.04}),
                 frame);
  }
  on_wall->Add(
      "sill", MakeBox({x - half - 0.1, -0.22, low - 0.08}, {x + half + 0.1, 0, low - 0.04}), frame);
}

void AddDoor(double x, Dice* draw, Thing* on_wall) {
  const Material frame = Paint(Rgb(0.62, 0.60, 0.55), 0.6, 0);
  on_wall->Add("door", MakeBox({x - 0.45, -0.03, 0}, {x + 0.45, 0, 2.05}),
               Paint(DrawPaint(draw), 0.45, 0, {Texture::Kind::kPlanks, 0.3, 0.15}));
  for (const double side : {-1.0, 1.0}) {
    on_wall->Add("door frame",
                 MakeBox({x + side * 0.5 - 0.05, -0.07, 0}, {x + side * 0.5 + 0.05, 0, 2.15}),
                 frame);
  }
  on_wall->Add("door frame", MakeBox({x - 0.55, -0.07, 2.05}, {x + 0.55, 0, 2.15}), frame);
  on_wall->Add("handle", MakeRod({x + 0.36, -0.08, 1.05}, {x + 0.24, -0.08, 1.05}, 0.012, 0.012),
               Paint(Rgb(0.4, 0.4, 0.4), 0.4, 0));
}

/// Posters and tiles: flush with the wall.
void AddFlush(double x, Dice* draw, Thing* on_wall) {
  if (draw->Chance(0.65)) {
    const double half = draw->Between(0.25, 0.5), middle = draw->Between(1.45, 1.7);
    on_wall->Add(
        "poster",
        MakeBox({x - half, -0.002, middle - 0.7 * half}, {x + half, 0, middle + 0.7 * half}),
        Paint(DrawPaint(draw), 0.5, 0, {Texture::Kind::kTiles, 0.1, 0.8}));
  } else {
    on_wall->Add("tiles", MakeBox({x - 0.6, -0.003, 0.9}, {x + 0.6, 0, 1.7}),
                 Paint(Rgb(0.25, 0.40, 0.45), 0.6, 0, {Texture::Kind::kTiles, 0.15, 0.6}));
  }
}

/// What hangs on a wall, in slots of 1.9 m.
void FillWall(const Plan& plan, const RoomWall& wall, int number, Dice* draw, Thing* room) {
  Thing on_wall(room->warmth());
  const int slots = static_cast<int>(wall.length / 1.9);
  const int door = number == 0 ? -1 : draw->Below(2 * slots);
  for (int i = 0; i < slots; ++i) {
    const double x = (i + 0.5 - 0.5 * slots) * 1.9;
    if (i == door) {
      AddDoor(x, draw, &on_wall);
    } else if (draw->Chance(0.35) && plan.ceiling - plan.floor > 2.4) {
      AddWindow(x, draw->Between(0.9, 1.4), draw, &on_wall);
    } else if (draw->Chance(0.75)) {
      AddFlush(x + draw->Between(-0.2, 0.2), draw, &on_wall);
    }
  }
  room->AddAll(wall.world_from_wall, on_wall);
}

/// Puts it somewhere along a wall with its back to it, where there is room.
void PutAtWall(const RoomWall& wall, const Furniture& f, Dice* draw, Plan* plan, Thing* room) {
  for (int attempt = 0; attempt < 12; ++attempt) {
    const double reach = 0.5 * wall.length - f.half_y - 0.05;
    if (reach <= 0) return;
    Rigid3 on_wall = Standing(draw->Between(-reach, reach), -f.half_x - 0.06, 0, M_PI / 2);
    const Rigid3 place = wall.world_from_wall * on_wall;
    const Vector3d half = (place.rotation * Vector3d(f.half_x, f.half_y, 0)).cwiseAbs();
    const Vector2d middle = place.translation.head<2>();
    if (!plan->Take(middle - half.head<2>(), middle + half.head<2>())) continue;
    room->AddAll(place, f.thing);
    return;
  }
}

/// Puts it on the free floor, most often before the cameras.
void PutOnFloor(const Furniture& f, Dice* draw, Plan* plan, Thing* room) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const double turn = draw->Between(-0.5, 0.5) + (draw->Chance(0.3) ? M_PI / 2 : 0);
    const double c = std::abs(std::cos(turn)), s = std::abs(std::sin(turn));
    const Vector2d half(c * f.half_x + s * f.half_y, s * f.half_x + c * f.half_y);
    const Vector2d low = plan->low + half, high = plan->high - half;
    const double from = draw->Chance(0.8) ? 1.9 + half.x() : low.x();
    const Vector2d middle{draw->Between(from, high.x()), draw->Between(low.y(), high.y())};
    if (!plan->Take(middle - half, middle + half)) continue;
    room->AddAll(Standing(middle.x(), middle.y(), plan->floor, turn), f.thing);
    return;
  }
}

Furniture DrawForWall(Dice* draw, const Warmth& warmth) {
  switch (draw->Below(4)) {
    case 0:
      return MakeCupboard(draw, warmth);
    case 1:
      return MakeRadiator(draw, warmth);
    case 2:
      return MakeSofa(draw, warmth);
    default:
      return MakeShelf(draw, warmth);
  }
}

void Furnish(const Options& options, Dice* draw, Plan* plan, Thing* room) {
  const double leaves = options.natural.leaves;
  const std::vector<RoomWall> walls = WallsOf(*plan);
  // Nothing is quite as warm as the air.
  const auto warmth = [&] { return Warmth{room->warmth().air_k + draw->Between(-1.6, 1.6), 0}; };
  for (int i = 0; i < 11; ++i) {
    // The far wall is in all views.
    const RoomWall& wall = walls[static_cast<std::size_t>(i < 3 ? 0 : draw->Below(4))];
    PutAtWall(wall, DrawForWall(draw, warmth()), draw, plan, room);
  }
  const auto put = [&](const Furniture& f) { PutOnFloor(f, draw, plan, room); };
  for (int i = 0; i < 3; ++i) put(MakeTableWithThings(draw, warmth(), leaves));
  for (int i = 0; i < 4; ++i) put(MakeChair(draw, warmth()));
  for (int i = 0; i < 3; ++i) put(MakePottedPlant(draw, warmth(), leaves));
  for (int i = 0; i < 3; ++i) put(MakeBoxes(draw, warmth()));
  put(MakeFloorLamp(warmth()));
}

/// Where the sun comes in: bright and warm, and no edge in range.
void AddSunPatches(const Plan& plan, Dice* draw, Thing* room) {
  for (int i = 0; i < 3; ++i) {
    const double x = draw->Between(1.5, plan.high.x() - 1.5),
                 y = draw->Between(plan.low.y(), plan.high.y() - 1);
    const double slant = draw->Between(-0.4, 0.4), z = plan.floor + 0.001 + 0.0004 * i;
    room->AddWarm("sun patch",
                  MakeQuad({x, y, z}, {x + 0.9, y + slant, z}, {x + 0.9, y + slant + 0.6, z},
                           {x, y + 0.6, z}),
                  Paint(Rgb(0.85, 0.72, 0.55), 0.4, room->warmth().air_k + draw->Between(1, 5)));
  }
}

void AddLamps(const Plan& plan, Dice* draw, std::vector<Light>* lights) {
  for (int i = 0; i < 4; ++i) {
    Light light;
    light.kind = Light::Kind::kPoint;
    const double x = i < 2 ? 0.25 : 0.75, y = i % 2 == 0 ? 0.25 : 0.75;
    light.place.x() =
        plan.low.x() + (x + draw->Between(-0.1, 0.1)) * (plan.high.x() - plan.low.x());
    light.place.y() =
        plan.low.y() + (y + draw->Between(-0.1, 0.1)) * (plan.high.y() - plan.low.y());
    light.place.z() = plan.ceiling - 0.15;
    light.color = Rgb(0.34, 0.32, 0.28) * draw->Between(0.5, 1.2);
    light.reach_m = 2.6;
    light.casts_shadows = i != 0 && i != 3;
    lights->push_back(light);
  }
}

}  // namespace

Thing MakeRoom(const Options& options, const Warmth& warmth, std::vector<Light>* lights) {
  Dice draw(options.seed, 0, "room");
  Plan plan = DrawPlan(options, &draw);
  Thing room(warmth);
  AddShell(plan, &draw, &room);
  const std::vector<RoomWall> walls = WallsOf(plan);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    FillWall(plan, walls[i], static_cast<int>(i), &draw, &room);
  }
  Furnish(options, &draw, &plan, &room);
  AddSunPatches(plan, &draw, &room);
  AddLamps(plan, &draw, lights);
  return room;
}

}  // namespace rgbdt::simulate
