// Writes LCM logs for map_test.sh: of fused clouds over level ground with a crate, 27 C warm; of
// poses only; and of the sweeps of a drive through a street, without a rig and with one, and the
// truth beside it: a line a sweep, time [us] x y z [m]; and of a drive that comes back to where it
// began, and of a turned scanner. Usage: map_test_log FUSED OTHER [DRIVE RIGGED TRUTH [LOOP
// TURNED]]
#include <cmath>
#include <fstream>

#include "calib/files/schema/rig_file.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/simulator.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"
#include "tests/study/drives.h"

namespace {

using rgbdt::RgbdtCloud;
using rgbdt::Utime;

constexpr Utime kNow = 1'500'000'000'000'000;

void AddPoint(float x, float y, float z, Utime utime, RgbdtCloud* cloud) {
  cloud->points.emplace_back(x, y, z);
  cloud->intensity.push_back(0.5F);
  cloud->utime.push_back(utime);
  cloud->rgb.push_back({100, 120, 90});
  cloud->temperature_k.push_back(300);
  cloud->thermal_counts.push_back(3000);
  cloud->valid.push_back(3);
}

// A line along y; the crate stands at x 2.7 to 3.3, y -0.3 to 0.3, and is 0.5 m high.
RgbdtCloud Line(int number) {
  RgbdtCloud cloud;
  cloud.seq = number;
  cloud.sweep_utime = kNow;
  cloud.cameras = {"rgb", "thermal"};
  cloud.calibration_utime = {kNow, kNow};
  const float x = 1 + 0.05F * static_cast<float>(number);
  for (float y = -4; y < 4; y += 0.05F) {
    const bool crate = std::abs(x - 3) < 0.3F && std::abs(y) < 0.3F;
    AddPoint(x, y, crate ? -0.7F : -1.2F, kNow + number * 1000, &cloud);
  }
  cloud.temperature_sigma_k.assign(cloud.size(), NAN);
  return cloud;
}

void Write(rgbdt::LogWriter* log, const rgbdt::Message& message, Utime heard = kNow) {
  log->Write(rgbdt::ChannelOf(message), rgbdt::Encode(message), heard);
}

rgbdt::CloudChunk Chunk(int sweep, rgbdt::study::Drive* drive) {
  rgbdt::CloudChunk chunk;
  chunk.seq = sweep;
  chunk.cloud = drive->Sweep(sweep);
  chunk.sweep_end = true;
  chunk.sweep_lines = chunk.cloud.lines;
  return chunk;
}

// 38 m along a street and back again.
void WriteLoop(const char* path) {
  constexpr double kLength = 38, kSpeed = 8;
  rgbdt::simulate::SpinningOptions lidar = rgbdt::simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 6;
  rgbdt::study::Drive drive(rgbdt::study::DriveScene::kStreet, 4, lidar,
                            rgbdt::study::ThereAndBackWay(kLength, kSpeed));
  rgbdt::LogWriter log(path);
  const double seconds = rgbdt::study::ThereAndBackSeconds(kLength, kSpeed);
  for (int i = 0; 0.1 * i < seconds; ++i) Write(&log, Chunk(i, &drive));
  log.Close();
}

// A turned scanner in a room: the rig stands for the first sweep and drives through two more.
void WriteTurned(const char* path) {
  rgbdt::study::TurningDrive drive(5, rgbdt::study::QuickScanner(), 0.4);
  rgbdt::LogWriter log(path);
  for (int i = 0; i < 3; ++i) {
    for (const rgbdt::CloudChunk& chunk : rgbdt::SplitSweep(drive.Sweep(i))) Write(&log, chunk);
  }
  log.Close();
}

void WriteDrive(const char* log_path, const char* rigged_path, const char* truth_path) {
  rgbdt::simulate::SpinningOptions lidar = rgbdt::simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 4;
  rgbdt::study::Drive drive(rgbdt::study::DriveScene::kStreet, 4, lidar,
                            rgbdt::study::StreetWay(4, 5));
  rgbdt::LogWriter log(log_path), rigged(rigged_path);
  const rgbdt::Rig rig = rgbdt::ParseRig(
      rgbdt::PrintRig(rgbdt::simulate::Simulator(rgbdt::simulate::Options()).rig()), "rig");
  std::ofstream truth(truth_path);
  truth.precision(9);
  for (int i = 0; i < 20; ++i) {
    const rgbdt::CloudChunk chunk = Chunk(i, &drive);
    const Utime last = chunk.cloud.utime.back();
    const Eigen::Vector3d place = drive.At(last).translation;
    truth << last << ' ' << place.x() << ' ' << place.y() << ' ' << place.z() << '\n';
    if (i == 3) Write(&rigged, rgbdt::RigText{0, rig.hash, rig.text}, last);  // it is repeated
    Write(&log, chunk, last);
    Write(&rigged, chunk, last);
  }
  log.Close();
  rigged.Close();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 6 && argc != 8) return 1;
  rgbdt::LogWriter fused(argv[1]);
  for (int line = 0; line < 160; ++line) Write(&fused, Line(line));
  fused.Close();
  rgbdt::LogWriter other(argv[2]);
  rgbdt::StampedPose pose;
  pose.utime = kNow;
  pose.source = "odometry";
  Write(&other, pose);
  other.Close();
  if (argc >= 6) WriteDrive(argv[3], argv[4], argv[5]);
  if (argc == 8) WriteLoop(argv[6]);
  if (argc == 8) WriteTurned(argv[7]);
  return 0;
}
