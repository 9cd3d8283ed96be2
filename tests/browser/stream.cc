#include "tests/browser/stream.h"

#include <chrono>
#include <thread>
#include <vector>

#include "calib/scan_assembly/sweep_chunks.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/turning_scanner.h"

namespace rgbdt::browser {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration_cast;
using std::chrono::microseconds;

Utime WallUtime() {
  return duration_cast<microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// A cloud's lines from `first` to before `end`, as if fired at `utime`.
CloudChunk ChunkOf(const Cloud& sweep, int first, int end, Utime utime) {
  const auto begin = static_cast<std::ptrdiff_t>(first) * sweep.beams;
  const auto stop = static_cast<std::ptrdiff_t>(end) * sweep.beams;
  CloudChunk chunk;
  Cloud& cloud = chunk.cloud;
  cloud.first_line = first;
  cloud.lines = end - first;
  cloud.beams = sweep.beams;
  cloud.points.assign(sweep.points.begin() + begin, sweep.points.begin() + stop);
  cloud.intensity.assign(sweep.intensity.begin() + begin, sweep.intensity.begin() + stop);
  cloud.utime.assign(cloud.points.size(), utime);
  return chunk;
}

class Streamer {
 public:
  explicit Streamer(const StreamOptions& options) : options_(options) {
    sweep_ = bench::ScannedRoom(bench::kInView, options.points, WallUtime());
    if (sweep_.intensity.empty()) sweep_.intensity.assign(sweep_.size(), 0.5F);
    for (const CameraSpec& camera : rig_.rig.cameras) {
      images_.push_back(bench::PictureOf(camera, WallUtime(), 1));
    }
  }

  void Run() {
    const auto tick = std::chrono::duration<double>(1 / (options_.sweeps_hz * options_.chunks));
    const auto tick_count = static_cast<std::int64_t>(options_.seconds / tick.count());
    const bool endless = options_.seconds > 1e9;
    const Clock::time_point start = Clock::now();
    double next_second = 0, next_image = 0;
    for (std::int64_t i = 0; endless || i < tick_count; ++i) {
      const auto at = static_cast<double>(i) * tick;
      std::this_thread::sleep_until(start + duration_cast<Clock::duration>(at));
      if (at.count() >= next_second) {
        next_second += 1;
        PublishState();
      }
      if (options_.images_hz > 0 && at.count() >= next_image) {
        next_image += 1 / options_.images_hz;
        PublishImages();
      }
      PublishChunk(static_cast<int>(i % options_.chunks));
    }
  }

 private:
  void Publish(Message message) {
    SetSeq(seq_[ChannelOf(message)]++, &message);
    bus_.Publish(ChannelOf(message), Encode(message));
  }

  void PublishState() {
    Publish(rig_.text);
    for (Message& message : rig_.Calibrations(calibrated_)) Publish(message);
  }

  void PublishImages() {
    for (Image& image : images_) {
      image.utime = WallUtime();
      ++image.frame_number;
      Publish(image);
    }
  }

  void PublishChunk(int number) {
    const Utime now = WallUtime();
    if (number == 0) sweep_utime_ = now;
    CloudChunk chunk = ChunkOf(sweep_, number * sweep_.lines / options_.chunks,
                               (number + 1) * sweep_.lines / options_.chunks, now);
    chunk.cloud.sweep_utime = sweep_utime_;
    chunk.sweep_end = number == options_.chunks - 1;
    if (chunk.sweep_end) chunk.sweep_lines = sweep_.lines;
    Publish(std::move(chunk));
  }

  StreamOptions options_;
  LcmBus bus_{""};
  bench::BenchRig rig_ = bench::MakeBenchRig();
  Cloud sweep_;
  std::vector<Image> images_;
  std::map<std::string, std::int64_t> seq_;
  Utime calibrated_ = WallUtime();
  Utime sweep_utime_ = 0;
};

}  // namespace

void Stream(const StreamOptions& options) { Streamer(options).Run(); }

}  // namespace rgbdt::browser
