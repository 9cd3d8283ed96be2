// How long a line of the scanner takes to come back fused, on LCM, in real time; and the memory of
// the fuser meanwhile.
//   bench_latency SECONDS FUSER_PID LATENCY_CSV MEMORY_CSV
// Publishes on LCM_DEFAULT_URL what a rig would: 25 lines a second of 400 beams with the encoder at
// 100 Hz, both default cameras at 10 Hz and full resolution, rendered beforehand; the rig and a
// calibration at 1 Hz. Lidar, cameras and receiver have a thread and a bus each. Measured is from
// before a line is published until the RGBDT_CLOUD with its points has been decoded, by the
// monotonic clock, for SECONDS after a warm-up of 3. LATENCY_CSV has a line for each line of the
// scanner, an empty latency where its chunk never came, and how many of its points all cameras saw;
// MEMORY_CSV the fuser's VmRSS each second.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/turning_scanner.h"
#include "tests/numbers.h"

namespace rgbdt::bench {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

constexpr int kWarmUpSeconds = 3;
constexpr Utime kFramePeriod = kMicrosecondsPerSecond / 10;
constexpr int kPictures = 4;
constexpr auto kPatience = std::chrono::seconds(10);  // for the processes to be ready
constexpr auto kLate = std::chrono::seconds(2);       // later than this is lost

void Publish(const Message& message, Bus* bus) {
  bus->Publish(ChannelOf(message), Encode(message));
}

struct Line {
  std::atomic<std::int64_t> sent_us{-1};  // on the monotonic clock, since the data's start
  std::int64_t received_us = -1;
  std::size_t points = 0, seen_by_all = 0;
};

class Run {
 public:
  explicit Run(int seconds)
      : lines_(static_cast<std::size_t>((kWarmUpSeconds + seconds) * kMicrosecondsPerSecond /
                                        TurningScanner::kLinePeriod)) {
    bus_.Subscribe("RGBDT_CLOUD|STATUS",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     const Message message = Decode(channel, data, size);
                     if (const auto* status = std::get_if<Status>(&message)) {
                       if (status->ready) ready_.insert(status->process);
                     } else if (const auto* cloud = std::get_if<RgbdtCloud>(&message)) {
                       Take(*cloud);
                     }
                   });
  }

  void WaitForProcesses() {
    const Clock::time_point end = Clock::now() + kPatience;
    while (ready_.count("assembler") == 0 || ready_.count("fuser") == 0) {
      if (Clock::now() > end) throw std::runtime_error("rgbdt-assembler or rgbdt-fuser is not up");
      PublishRig(&bus_);
      bus_.Run(100);
    }
  }

  void Measure(const std::string& fuser_pid, const std::string& memory_csv) {
    std::ofstream memory(memory_csv);
    memory << "second,rss_mb\n";
    start_ = Clock::now();
    std::vector<std::thread> threads;
    threads.emplace_back([this] { SendScans(); });
    for (std::size_t c = 0; c < rig_.rig.cameras.size(); ++c) {
      threads.emplace_back([this, c] { SendImages(c); });
    }
    const Utime end = EndOfData();
    Utime next_sample = 0;
    while (Clock::now() < start_ + microseconds(end) + kLate) {
      bus_.Run(10);
      if (SinceStart() < next_sample || next_sample > end) continue;
      memory << ToSeconds(next_sample) << ',' << ResidentMegabytes(fuser_pid) << '\n';
      next_sample += kMicrosecondsPerSecond;
    }
    for (std::thread& thread : threads) thread.join();
    if (!memory.flush()) throw std::runtime_error("cannot write " + memory_csv);
  }

  void Write(const std::string& path) const {
    std::ofstream csv(path);
    csv << "second,latency_ms,points,seen_by_all\n";
    for (const Line& line : lines_) {
      const std::int64_t sent = line.sent_us.load();
      if (sent < kWarmUpSeconds * kMicrosecondsPerSecond) continue;
      csv << ToSeconds(sent) << ',';
      if (line.received_us >= 0) csv << 1e-3 * static_cast<double>(line.received_us - sent);
      csv << ',' << line.points << ',' << line.seen_by_all << '\n';
    }
    if (!csv.flush()) throw std::runtime_error("cannot write " + path);
  }

 private:
  Utime SinceStart() const {
    return std::chrono::duration_cast<microseconds>(Clock::now() - start_).count();
  }
  Utime EndOfData() const {
    return static_cast<Utime>(lines_.size()) * TurningScanner::kLinePeriod;
  }
  void PublishRig(Bus* bus) {
    Publish(rig_.text, bus);
    ++rig_.text.seq;
  }
  void WaitUntil(Utime t) const { std::this_thread::sleep_until(start_ + microseconds(t)); }

  // A line when its last beam has been fired, and then the reading of that moment.
  void SendScans() {
    LcmBus bus("");
    std::int64_t calibrations = 0;
    for (Utime t = 0; t <= EndOfData(); t += TurningScanner::kReadingPeriod) {
      WaitUntil(t);
      if (t > 0 && t % TurningScanner::kLinePeriod == 0) {
        const std::int64_t number = t / TurningScanner::kLinePeriod - 1;
        const LineScan line = scanner_.Line(number);
        lines_[static_cast<std::size_t>(number)].sent_us = SinceStart();
        Publish(line, &bus);
      }
      Publish(scanner_.Reading(t / TurningScanner::kReadingPeriod), &bus);
      if (t % kMicrosecondsPerSecond != 0) continue;
      PublishRig(&bus);
      for (Message& message : rig_.Calibrations(kJune2015)) {
        SetSeq(calibrations++, &message);
        Publish(message, &bus);
      }
    }
  }

  // Each image when it has been read out; the cameras are not in step.
  void SendImages(std::size_t c) {
    LcmBus bus("");
    const CameraSpec& camera = rig_.rig.cameras[c];
    std::vector<Image> pictures;
    pictures.reserve(kPictures);
    for (int k = 0; k < kPictures; ++k) pictures.push_back(PictureOf(camera, kJune2015, k));
    std::int64_t frame = 0;
    for (Utime t = static_cast<Utime>(c) * 37'000; t <= EndOfData(); t += kFramePeriod) {
      WaitUntil(t + FromSeconds(camera.readout_s));
      Image& image = pictures[static_cast<std::size_t>(frame % kPictures)];
      image.utime = kJune2015 + t;
      image.seq = image.frame_number = frame++;
      Publish(image, &bus);
    }
  }

  void Take(const RgbdtCloud& cloud) {
    if (cloud.whole_sweep || cloud.utime.empty()) return;
    const Utime number = (cloud.utime.front() - kJune2015) / TurningScanner::kLinePeriod;
    if (number < 0 || number >= static_cast<Utime>(lines_.size())) return;
    Line& line = lines_[static_cast<std::size_t>(number)];
    line.received_us = SinceStart();
    line.points = cloud.size();
    const auto all = (std::uint32_t{1} << cloud.cameras.size()) - 1;
    line.seen_by_all = 0;
    for (const std::uint32_t valid : cloud.valid) line.seen_by_all += valid == all ? 1U : 0U;
  }

  static double ResidentMegabytes(const std::string& pid) {
    std::ifstream status("/proc/" + pid + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
    }
    throw std::runtime_error("process " + pid + " is gone");
  }

  LcmBus bus_{""};
  BenchRig rig_ = MakeBenchRig();
  const TurningScanner scanner_{kJune2015};
  std::vector<Line> lines_;
  std::set<std::string> ready_;
  Clock::time_point start_;
};

}  // namespace
}  // namespace rgbdt::bench

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "Usage: bench_latency SECONDS FUSER_PID LATENCY_CSV MEMORY_CSV\n";
    return 2;
  }
  try {
    rgbdt::bench::Run run(std::stoi(argv[1]));
    run.WaitForProcesses();
    run.Measure(argv[2], argv[4]);
    run.Write(argv[3]);
  } catch (const std::exception& error) {
    std::cerr << "bench_latency: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
