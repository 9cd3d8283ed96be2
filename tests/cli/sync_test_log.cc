// Writes an LCM log for sync_test.sh of a board that is waved before a colour camera, whose clock
// is 0.25 s behind and whose shutter rolls for 15 ms, and a LIDAR of 32 rings; one without a rig;
// and a calibration that is off by half a degree. Usage: sync_test_log LOG OTHER CALIBRATION
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/simulate/waving.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"
#include "tests/simulated_variants.h"

namespace {

using rgbdt::Utime;

void Write(rgbdt::LogWriter* log, const rgbdt::Message& message, Utime utime) {
  log->Write(rgbdt::ChannelOf(message), rgbdt::Encode(message), utime);
}

void WriteCalibrationOff(const rgbdt::simulate::Waving& waving, const rgbdt::Rig& rig,
                         const char* path) {
  rgbdt::Calibration calibration;
  calibration.method = "auto";
  calibration.rig_hash = rig.hash;
  rgbdt::CameraCalibration camera;
  camera.camera = "rgb";
  rgbdt::Vector6d off;
  off << 0.005, -0.005, 0.005, 0.01, 0.01, -0.01;
  camera.camera_from_lidar = rgbdt::Exp(off) * waving.truth().camera_from_lidar.at("rgb");
  camera.status = rgbdt::SolveStatus::kConverged;
  calibration.cameras = {camera};
  rgbdt::WriteCalibration(path, calibration);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 1;
  const rgbdt::simulate::WaveOptions wave;
  rgbdt::simulate::ClockOptions clock;
  clock.offset_s = 0.25;
  clock.rolling_s = 0.015;
  rgbdt::simulate::Waving waving(rgbdt::simulate::OneCamera(7, 32, 640), wave, {clock});
  const rgbdt::Rig rig = rgbdt::ParseRig(rgbdt::PrintRig(waving.rig()), "rig");
  WriteCalibrationOff(waving, rig, argv[3]);
  rgbdt::LogWriter log(argv[1]), other(argv[2]);
  for (int i = 0; i < 50; ++i) {  // 5 s, ten sweeps and as many images a second
    const Utime utime = wave.start + i * 100'000;
    rgbdt::CloudChunk chunk;
    chunk.seq = i;
    chunk.cloud = waving.Sweep(utime);
    chunk.sweep_end = true;
    chunk.sweep_lines = chunk.cloud.lines;
    if (i == 3)
      Write(&log, rgbdt::RigText{0, rig.hash, rig.text}, utime);  // once a second it comes
    Write(&log, chunk, utime);
    if (i < 2) Write(&other, chunk, utime);
    rgbdt::Image image = waving.TakeImage("rgb", utime + 37'000);
    image.seq = i;
    Write(&log, image, utime);
  }
  log.Close();
  other.Close();
  return 0;
}
