// Odometry on simulated drives whose truth is known.
//   study_odometry SCENE RINGS SPEED_MPS SEED SWEEPS CSV
// SCENE: street, room, corridor or plain; or, with the turned scanner in the room (RINGS do not
// count): stops, a sweep every metre (nor does SPEED_MPS), or turning, which drives while it
// sweeps. A line of CSV for each sweep: where the LIDAR truly was and where it was found, in its
// middle, since the first sweep; what was said; one core's time; how far the way that was driven
// meanwhile is off at most.
#include <algorithm>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "calib/odometry/odometry.h"
#include "tests/study/drives.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

// This thread's own: other threads cast the rays, and others share the machine.
double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Drive MakeDrive(const std::string& scene, int rings, double speed, std::uint64_t seed) {
  static const std::map<std::string, DriveScene> scenes = {{"street", DriveScene::kStreet},
                                                           {"room", DriveScene::kRoom},
                                                           {"corridor", DriveScene::kCorridor},
                                                           {"plain", DriveScene::kPlain}};
  const auto found = scenes.find(scene);
  if (found == scenes.end()) {
    throw InputError("scene is " + scene +
                     "; expected street, room, corridor, plain, stops or turning");
  }
  const double aside = found->second == DriveScene::kCorridor ? 0.2 : 0.7;
  return {
      found->second, seed, simulate::SpinningLidar(rings),
      found->second == DriveScene::kRoom ? RoomWay(seed, speed) : StreetWay(seed, speed, aside)};
}

void WritePose(std::ostream& out, const Rigid3& pose) {
  out << ',' << pose.translation.x() << ',' << pose.translation.y() << ',' << pose.translation.z()
      << ',' << pose.rotation.x() << ',' << pose.rotation.y() << ',' << pose.rotation.z() << ','
      << pose.rotation.w();
}

/// Sweep by sweep; and where the LIDAR truly was, by the sweep's number and the time of its pose.
struct Source {
  std::function<Cloud(int number)> sweep;
  std::function<Rigid3(int number, Utime utime)> truth;
};

Source SourceOf(const std::string& scene, int rings, double speed, std::uint64_t seed) {
  if (scene == "stops") {
    constexpr double kApart = 1;  // [m]
    const auto stops = std::make_shared<Stops>(seed, simulate::FullTurnScanner(), kApart);
    return {[=](int number) { return stops->Sweep(number); },
            [=](int number, Utime) { return stops->At(number); }};
  }
  if (scene == "turning") {
    const auto drive = std::make_shared<TurningDrive>(seed, QuickScanner(), speed);
    return {[=](int number) { return drive->Sweep(number); },
            [=](int, Utime utime) { return drive->At(utime); }};
  }
  const auto drive = std::make_shared<Drive>(MakeDrive(scene, rings, speed, seed));
  return {[=](int number) { return drive->Sweep(number); },
          [=](int, Utime utime) { return drive->At(utime); }};
}

// How far a way is off at most [m]; 0: there is none.
double MostOff(const std::vector<PoseAtTime>& way, const Rigid3& truth_from_world,
               const std::function<Rigid3(Utime utime)>& truth) {
  double most = 0;
  for (const PoseAtTime& pose : way) {
    const Rigid3 found = truth_from_world * pose.world_from_lidar;
    most = std::max(most, (found.translation - truth(pose.utime).translation).norm());
  }
  return most;
}

void Run(const std::vector<std::string>& a) {
  const Source source = SourceOf(a[0], std::stoi(a[1]), std::stod(a[2]), std::stoull(a[3]));
  std::ofstream csv(a[5]);
  csv.precision(12);
  csv << "sweep,converged,degenerate,points,matched,iterations,seconds,lasts,sigma_m,way_off_m,"
         "true_x,true_y,true_z,true_qx,true_qy,true_qz,true_qw,x,y,z,qx,qy,qz,qw\n";
  Odometry odometry;
  std::optional<Rigid3> first;
  for (int i = 0; i < std::stoi(a[4]); ++i) {
    const Cloud sweep = source.sweep(i);
    const double before = CpuSeconds();
    const OdometryResult found = odometry.Add(sweep);
    const double seconds = CpuSeconds() - before;
    const Rigid3 truth = source.truth(i, found.middle_utime);
    if (!first) first = truth * found.world_from_middle.Inverse();
    csv << i << ',' << found.converged << ',' << found.degenerate.size() << ',' << found.points
        << ',' << found.matched << ',' << found.iterations << ',' << seconds << ','
        << ToSeconds(found.utime - found.first_utime) << ','
        << std::sqrt(found.covariance.bottomRightCorner<3, 3>().trace()) << ','
        << MostOff(found.way, *first, [&](Utime utime) { return source.truth(i, utime); });
    WritePose(csv, truth);
    WritePose(csv, *first * found.world_from_middle);
    csv << '\n';
  }
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_odometry", "SCENE RINGS SPEED_MPS SEED SWEEPS CSV", 6, 6, rgbdt::study::Run}, argc,
      argv);
}
