// How thick the walls of a drive's map are where it comes back to where it began: round a block of
// streets, odometry from the sweeps, loops closed (calib/odometry/loop_closure.h).
//   study_map block|twins RINGS SPEED_MPS SEED CSV
// block: once round and 30 m on. twins: three quarters of a round on which half the block looks
// like the other half, stone by stone, so that each loop is a false one.
// One line of CSV: loops, how many of these are false, how many were refused; how far the poses are
// off; the median thickness of walls that were seen early and late (RMS distance from the plane of
// a patch of half a metre) by the true poses, by odometry and with the loops closed.
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "calib/odometry/loop_closure.h"
#include "tests/study/drives.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

// Of odometry's map so much is kept: with its own 100 m it would never lose sight of the block,
// come back into its own map, and have hardly any loop to close.
constexpr double kKept = 40;         // [m]
constexpr double kOn = 30;           // [m] after the round
constexpr double kAbout = 60;        // [m] of the way about its beginning and end: points are kept
constexpr double kPatch = 0.5;       // [m] side
constexpr double kFlat = 0.025;      // [m] by the true poses: a patch that is a wall
constexpr double kUpright = 0.2;     // of the normal's z
constexpr double kFewest = 40;       // points of early and of late sweeps
constexpr double kReach = 25;        // [m] of points taken
constexpr std::size_t kEvery = 3;    // a point of so many is kept
constexpr double kFalse = 0.3;       // [m]
constexpr double kFalseTurn = 0.02;  // [rad]

struct Seen {
  Eigen::Vector3f in_middle, truly;  // in the sweep's middle, as odometry straightens it; the world
  std::size_t sweep;
};

struct Sums {
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d outer = Eigen::Matrix3d::Zero();

  void Add(const Eigen::Vector3d& p) {
    ++count;
    sum += p;
    outer += p * p.transpose();
  }
  Eigensystem<3> Shape() const {
    const Eigen::Vector3d mean = sum / count;
    return EigensystemOf<3>(Eigen::Matrix3d(outer / count - mean * mean.transpose()));
  }
  double Thickness() const { return std::sqrt(std::max(0.0, Shape().values[0])); }
};

struct Patch {
  std::array<Sums, 3> by;            // true poses, odometry's, closed
  std::array<double, 2> seen{0, 0};  // points of early sweeps, of late ones
};

struct Driven {
  std::vector<Seen> seen;
  std::vector<Rigid3> truth, open, closed;  // world_from_lidar in the middle of each sweep
  std::vector<double> along;                // [m] of the way
  ClosedWay way;
  double seconds = 0;  // of this thread, to close the loops
};

double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void Keep(const Cloud& sweep, const OdometryResult& found, const Drive& drive, Driven* driven) {
  const std::size_t number = driven->truth.size() - 1;
  for (std::size_t i = number % kEvery; i < sweep.size(); i += kEvery) {
    const Eigen::Vector3d point = sweep.points[i].cast<double>();
    if (!(point.norm() < kReach)) continue;
    const double after = ToSeconds(sweep.utime[i] - found.middle_utime);
    driven->seen.push_back({(Exp(Vector6d(after * found.velocity)) * point).cast<float>(),
                            (drive.At(sweep.utime[i]) * point).cast<float>(), number});
  }
}

Driven DriveIt(double way_m, Drive* drive) {
  Driven driven;
  OdometryOptions options;
  options.keep_m = kKept;
  Odometry odometry(options);
  Keyframes keyframes;
  std::vector<Utime> utimes;
  Rigid3 truth_from_world;
  double along = 0;
  for (int i = 0; along < way_m; ++i) {
    const Cloud sweep = drive->Sweep(i);
    const OdometryResult found = odometry.Add(sweep);
    keyframes.Add(sweep, found);
    const Rigid3 truth = drive->At(found.middle_utime);
    if (i == 0) {
      truth_from_world = truth * found.world_from_middle.Inverse();
    } else {
      along += (truth.translation - driven.truth.back().translation).norm();
    }
    driven.truth.push_back(truth);
    driven.open.push_back(truth_from_world * found.world_from_middle);
    driven.closed.push_back(found.world_from_middle);
    driven.along.push_back(along);
    utimes.push_back(found.middle_utime);
    if (found.converged && std::min(along, way_m - along) < kAbout) {
      Keep(sweep, found, *drive, &driven);
    }
  }
  const double before = CpuSeconds();
  driven.way = CloseLoops(keyframes);
  driven.seconds = CpuSeconds() - before;
  for (std::size_t i = 0; i < driven.closed.size(); ++i) {
    driven.closed[i] = truth_from_world * driven.way.Corrected(utimes[i], driven.closed[i]);
  }
  return driven;
}

// By cells of space as the truth has it, so that a patch is of the same points whatever the poses.
std::map<std::array<int, 3>, Patch> Patches(const Driven& driven) {
  std::map<std::array<int, 3>, Patch> patches;
  for (const Seen& s : driven.seen) {
    std::array<int, 3> cell{};
    for (int k = 0; k < 3; ++k) {
      cell[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(s.truly[k] / kPatch));
    }
    Patch& patch = patches[cell];
    const Eigen::Vector3d in_middle = s.in_middle.cast<double>();
    patch.by[0].Add(s.truly.cast<double>());
    patch.by[1].Add(driven.open[s.sweep] * in_middle);
    patch.by[2].Add(driven.closed[s.sweep] * in_middle);
    ++patch.seen[driven.along[s.sweep] < 0.5 * driven.along.back() ? 0 : 1];
  }
  return patches;
}

bool IsWall(const Patch& patch) {
  if (std::min(patch.seen[0], patch.seen[1]) < kFewest) return false;
  return patch.by[0].Thickness() < kFlat && std::abs(patch.by[0].Shape().vectors(2, 0)) < kUpright;
}

double Rms(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    sum += (found[i].translation - truth[i].translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(found.size()));
}

// [m]: by how much the end lies off the beginning.
double EndOff(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  const Rigid3 step = found.front().Inverse() * found.back();
  const Rigid3 true_step = truth.front().Inverse() * truth.back();
  return (step.translation - true_step.translation).norm();
}

int FalseLoops(const ClosedWay& way, const Drive& drive) {
  int count = 0;
  for (const ClosedLoop& loop : way.loops) {
    const Rigid3 truly = drive.At(loop.old_utime).Inverse() * drive.At(loop.new_utime);
    const Rigid3 off = loop.old_from_new.Inverse() * truly;
    if (off.translation.norm() > kFalse || RotationDistance(off, {}) > kFalseTurn) ++count;
  }
  return count;
}

// As text, empty where there is none.
std::string Median(std::vector<double> values) {
  if (values.empty()) return "";
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::to_string(*middle);
}

void Run(const std::vector<std::string>& a) {
  if (a[0] != "block" && a[0] != "twins") {
    throw InputError("scene is " + a[0] + "; expected block or twins");
  }
  const bool twins = a[0] == "twins";
  const std::uint64_t seed = std::stoull(a[3]);
  Drive drive(twins ? DriveScene::kTwins : DriveScene::kBlock, seed,
              simulate::SpinningLidar(std::stoi(a[1])), BlockWay(seed, std::stod(a[2])));
  const Driven driven = DriveIt(twins ? 0.75 * BlockRound() : BlockRound() + kOn, &drive);
  std::array<std::vector<double>, 3> thickness;
  for (const auto& [cell, patch] : Patches(driven)) {
    if (!IsWall(patch)) continue;
    for (std::size_t k = 0; k < 3; ++k) thickness[k].push_back(1e3 * patch.by[k].Thickness());
  }
  std::ofstream csv(a[4]);
  csv << "loops,false_loops,tried,refused,way_m,end_moved_m,open_end_m,closed_end_m,open_rms_m,"
         "closed_rms_m,seconds,walls,true_mm,open_mm,closed_mm\n"
      << driven.way.loops.size() << ',' << FalseLoops(driven.way, drive) << ',' << driven.way.tried
      << ',' << driven.way.refused() << ',' << driven.along.back() << ',' << driven.way.end_moved_m
      << ',' << EndOff(driven.open, driven.truth) << ',' << EndOff(driven.closed, driven.truth)
      << ',' << Rms(driven.open, driven.truth) << ',' << Rms(driven.closed, driven.truth) << ','
      << driven.seconds << ',' << thickness[0].size();
  for (const std::vector<double>& own : thickness) csv << ',' << Median(own);
  csv << '\n';
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_map", "block|twins RINGS SPEED_MPS SEED CSV", 5, 5, rgbdt::study::Run}, argc, argv);
}
