// Writes an LCM log: the default scanner at 25 lines a second and its encoder at 100 Hz, both
// default cameras, the rig and a calibration; no session. The same log each time.
//   bench_log SECONDS FRAMES_PER_SECOND LOG
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "services/bus/log_writer.h"
#include "services/messages/codec.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/turning_scanner.h"
#include "tests/numbers.h"

namespace rgbdt::bench {
namespace {

constexpr int kPictures = 4;  // of each camera, one after the other

class Log {
 public:
  Log(int frames_per_second, const std::string& path)
      : log_(path), frame_period_(kMicrosecondsPerSecond / frames_per_second) {
    for (const CameraSpec& camera : rig_.rig.cameras) {
      for (int k = 0; k < kPictures; ++k) pictures_.push_back(PictureOf(camera, kJune2015, k));
    }
  }

  void Write(int seconds) {
    const Utime end = seconds * kMicrosecondsPerSecond;
    for (Utime t = 0; t <= end; t += TurningScanner::kReadingPeriod) WriteAt(t);
    log_.Close();
  }

 private:
  void WriteAt(Utime t) {
    if (t % kMicrosecondsPerSecond == 0) {
      rig_.text.seq = t / kMicrosecondsPerSecond;
      Put(rig_.text, t);
      for (Message& message : rig_.Calibrations(kJune2015)) {
        SetSeq(calibrations_++, &message);
        Put(message, t);
      }
    }
    if (t % frame_period_ == 0) WriteImages(t);
    if (t > 0 && t % TurningScanner::kLinePeriod == 0) {
      Put(scanner_.Line(t / TurningScanner::kLinePeriod - 1), t);
    }
    Put(scanner_.Reading(t / TurningScanner::kReadingPeriod), t);
  }

  void WriteImages(Utime t) {
    const std::int64_t frame = t / frame_period_;
    for (std::size_t c = 0; c < rig_.rig.cameras.size(); ++c) {
      Image image = pictures_[c * kPictures + static_cast<std::size_t>(frame % kPictures)];
      image.utime = kJune2015 + t;
      image.seq = image.frame_number = frame;
      Put(image, t);
    }
  }

  void Put(const Message& message, Utime t) {
    log_.Write(ChannelOf(message), Encode(message), kJune2015 + t);
  }

  LogWriter log_;
  Utime frame_period_;
  BenchRig rig_ = MakeBenchRig();
  TurningScanner scanner_{kJune2015};
  std::vector<Image> pictures_;
  std::int64_t calibrations_ = 0;
};

}  // namespace
}  // namespace rgbdt::bench

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "Usage: bench_log SECONDS FRAMES_PER_SECOND LOG\n";
    return 2;
  }
  try {
    rgbdt::bench::Log(std::stoi(argv[2]), argv[3]).Write(std::stoi(argv[1]));
  } catch (const std::exception& error) {
    std::cerr << "bench_log: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
