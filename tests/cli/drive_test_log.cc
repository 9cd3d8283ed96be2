// Writes an LCM log of a drive without captures, from a session of the simulator's: RIG, and view
// by view images, then the sweep in chunks, 20 s (or BETWEEN) after the view before; all views
// ROUNDS times. Beside it the true calibration. Usage: drive_test_log SESSION ROUNDS LOG
// CALIBRATION [BETWEEN]
#include <cstdio>
#include <map>
#include <string>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

constexpr Utime kReplayed = 500'000;

class Drive {
 public:
  explicit Drive(const std::string& log) : log_(log) {}

  void Write(Message message) {
    SetSeq(seq_[ChannelOf(message)]++, &message);
    log_.Write(ChannelOf(message), Encode(message), now_);
  }
  void WriteView(View view, Utime utime) {
    const Utime later = utime - view.cloud.sweep_utime;
    view.cloud.sweep_utime += later;
    for (Utime& time : view.cloud.utime) time += later;
    for (Image& image : view.images) {
      image.utime += later;
      if (image.format == PixelFormat::kBgr8) image.format = PixelFormat::kJpeg;  // it fits the bus
      Write(image);
    }
    for (const CloudChunk& chunk : SplitSweep(view.cloud)) Write(chunk);
    now_ += kReplayed;
  }
  void Close() { log_.Close(); }

 private:
  LogWriter log_;
  std::map<std::string, std::int64_t> seq_;
  Utime now_ = 1'500'000'000'000'000;
};

void Run(char** argv, Utime between) {
  const Session session = OpenSession(argv[1]);
  Drive drive(argv[3]);
  RigText rig;
  rig.hash = session.rig.hash;
  rig.text = session.rig.text;
  Utime utime = 1'500'000'000'000'000;
  for (int round = 0; round < std::stoi(argv[2]); ++round) {
    for (const std::string& view : session.views) {
      drive.Write(rig);
      drive.WriteView(ReadView(session, view), utime += between);
    }
  }
  drive.Close();
  Calibration calibration;
  calibration.method = "auto";
  calibration.rig_hash = session.rig.hash;
  calibration.utime = utime;
  for (const auto& [camera, pose] : ReadTruth(session.root / "truth.textproto").camera_from_lidar) {
    CameraCalibration& one = calibration.cameras.emplace_back();
    one.camera = camera;
    one.camera_from_lidar = pose;
    one.status = SolveStatus::kConverged;
    one.covariance = Matrix6d(1e-7 * Matrix6d::Identity());
  }
  WriteCalibration(argv[4], calibration);
}

}  // namespace
}  // namespace rgbdt

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) return 2;
  try {
    rgbdt::Run(argv, rgbdt::FromSeconds(argc == 6 ? std::stod(argv[5]) : 20));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "drive_test_log: %s\n", e.what());
    return 1;
  }
  return 0;
}
