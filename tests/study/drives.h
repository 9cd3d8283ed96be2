#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/ways.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

enum class DriveScene {
  kStreet,    ///< of calib/simulate, without end
  kRoom,      ///< likewise, furnished
  kCorridor,  ///< two walls, floor and ceiling, 600 m: nothing tells the way along it
  kPlain,     ///< a flat ground alone
  kBlock,     ///< four streets about a square, its crossings free of what would stand in the way
  kTwins,     ///< likewise; from where the LIDAR is half the round later all looks the same
};

using simulate::MovingSweep;
using simulate::RoomWay;
using simulate::StreetWay;
using simulate::Way;

/// As RoomWay, slowly: all of it goes with the way.
Way SlowRoomWay(std::uint64_t seed, double speed_mps);

/// Along x for `length_m`, half a turn on the spot, and back beside where it came from. Sets off
/// and stops softly each way; stands for good at its end, after ThereAndBackSeconds.
Way ThereAndBackWay(double length_m, double speed_mps);
double ThereAndBackSeconds(double length_m, double speed_mps);
/// Round the block to the left, as long as one likes: a round of BlockRound(), at about this speed
/// and over streets as StreetWay's.
Way BlockWay(std::uint64_t seed, double speed_mps);
double BlockRound();  ///< [m]

/// The sweeps of a spinning LIDAR on its way. Sweep and noise are functions of (seed, number).
class Drive {
 public:
  Drive(DriveScene scene, std::uint64_t seed, const simulate::SpinningOptions& lidar, Way way);

  /// Sweep 0, 1, ...
  Cloud Sweep(int number);
  /// world_from_lidar at a time.
  Rigid3 At(Utime utime) const;

 private:
  void MakeWorld(double x_m);
  std::vector<simulate::SceneObject> Block() const;

  DriveScene scene_;
  simulate::Options options_;
  simulate::SpinningOptions lidar_;
  Way way_;
  std::optional<simulate::World> world_;
  double world_x_ = 0;
};

/// FullTurnScanner eight times as fast, with half the beams: all the way round in 3.75 s, by 139
/// lines.
simulate::ScannerOptions QuickScanner();

/// Sweeps of a turned scanner on a rig that stands for each, in a furnished room, and goes on along
/// RoomWay in between. Sweep and noise are functions of (seed, number).
class Stops {
 public:
  Stops(std::uint64_t seed, const simulate::ScannerOptions& scanner, double apart_m);

  Cloud Sweep(int number) const;
  /// world_from_lidar
  Rigid3 At(int number) const;

 private:
  simulate::Options options_;
  simulate::Scanner scanner_;
  Way way_;  // by metres
};

/// Sweeps of a turned scanner, one behind the other, on a rig that stands for the first and then
/// drives through a furnished room while it sweeps. Every other sweep turns back.
class TurningDrive {
 public:
  TurningDrive(std::uint64_t seed, const simulate::ScannerOptions& scanner, double speed_mps);

  Cloud Sweep(int number);
  /// As if it stood where it is when the sweep begins.
  Cloud StandingSweep(int number);
  /// world_from_lidar at a time.
  Rigid3 At(Utime utime) const;

 private:
  Utime BeginOf(int number) const;

  simulate::Options options_;
  simulate::Scanner scanner_;
  std::shared_ptr<const simulate::World> world_;
  Way way_;
};

}  // namespace rgbdt::study
