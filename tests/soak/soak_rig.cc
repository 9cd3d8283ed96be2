// A rig's load on the bus, and what comes of it:
//   soak_rig SECONDS LOAD DIR PROCESS...
// Publishes on LCM_DEFAULT_URL, from when each PROCESS has said its STATUS, LOAD times what a large
// rig does: two colour cameras at 20 Hz, a thermal one at 30 Hz, clouds of 128 beams and 1,000
// columns at 10 Hz in 10 messages, SESSION_COMMANDs at 10 Hz at any LOAD; rig and calibration at
// 1 Hz. Lidar, commands and cameras have a thread and a bus each. Prints "begun", publishes for
// SECONDS or until SIGTERM, and listens for 3 s more. Then DIR has
//   latency.csv   second,late_ms,latency_ms: of each CLOUD by how much it was sent too late and how
//                 long until its RGBDT_CLOUD was decoded; empty: it never came
//   status.csv    second,process,counter,value: messages received, and missed by channel
//   sent.csv      channel,messages; "answered" commands are the solver's answers
// Seconds are of the monotonic clock.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/turning_scanner.h"

namespace rgbdt::bench {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::duration_cast;
using std::chrono::microseconds;

constexpr Utime kStart = 1'433'160'000'000'000;
constexpr double kSweepsHz = 10, kColorHz = 20, kThermalHz = 30, kCommandsHz = 10;
constexpr std::int64_t kPoints = 128'000;  // of a sweep; ScannedRoom makes 128 beams of them
constexpr int kChunks = 10;                // of a sweep
constexpr std::int64_t kSessionId = std::int64_t{1} << 20;
constexpr auto kPatience = std::chrono::seconds(60);  // for the processes to be there
constexpr auto kLastWords = std::chrono::seconds(3);  // a STATUS and more

volatile std::sig_atomic_t stopped = 0;

double Seconds(Clock::time_point t) {
  return std::chrono::duration<double>(t.time_since_epoch()).count();
}

BenchRig LargeRig() {
  BenchRig made = MakeBenchRig();
  made.rig.cameras.insert(made.rig.cameras.begin() + 1, made.rig.cameras.front());
  made.rig.cameras[1].name = "rgb2";
  made.camera_from_lidar.insert(made.camera_from_lidar.begin() + 1, made.camera_from_lidar.front());
  made.text.text = PrintRig(made.rig);
  made.rig = ParseRig(made.text.text, "soak rig");
  made.text.hash = made.rig.hash;
  return made;
}

// A sweep's messages, as those of a spinning LIDAR that says each when its last column was fired.
std::vector<CloudChunk> SweepInChunks() {
  const Cloud sweep = ScannedRoom(kAllRound, kPoints, kStart);
  std::vector<CloudChunk> chunks(kChunks);
  for (int number = 0; number < kChunks; ++number) {
    CloudChunk& chunk = chunks[static_cast<std::size_t>(number)];
    chunk.cloud.first_line = number * sweep.lines / kChunks;
    chunk.cloud.lines = (number + 1) * sweep.lines / kChunks - chunk.cloud.first_line;
    chunk.cloud.beams = sweep.beams;
    const auto first = static_cast<std::ptrdiff_t>(chunk.cloud.first_line) * sweep.beams;
    const auto end = first + static_cast<std::ptrdiff_t>(chunk.cloud.lines) * sweep.beams;
    chunk.cloud.points.assign(sweep.points.begin() + first, sweep.points.begin() + end);
    chunk.cloud.intensity.assign(chunk.cloud.points.size(), 0.5F);
    chunk.sweep_end = number == kChunks - 1;
    if (chunk.sweep_end) chunk.sweep_lines = sweep.lines;
  }
  return chunks;
}

struct Chunk {
  std::atomic<std::int64_t> sent_us{-1};  // since the load began
  std::int64_t late_us = 0, received_us = -1;
};

class Soak {
 public:
  Soak(double seconds, double load, std::string dir)
      : seconds_(seconds),
        load_(load),
        dir_(std::move(dir)),
        chunks_(static_cast<std::size_t>(seconds * kSweepsHz * kChunks * load) + 1),
        statuses_(dir_ + "/status.csv") {
    statuses_ << "second,process,counter,value\n" << std::fixed;
    bus_.Subscribe("RGBDT_CLOUD|STATUS|SESSION_EVENT",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     const Message message = Decode(channel, data, size);
                     if (const auto* status = std::get_if<Status>(&message)) Take(*status);
                     if (const auto* cloud = std::get_if<RgbdtCloud>(&message)) Take(*cloud);
                     if (const auto* event = std::get_if<SessionEvent>(&message)) Take(*event);
                   });
  }

  void WaitFor(const std::set<std::string>& processes) {
    const Clock::time_point end = Clock::now() + kPatience;
    for (const std::string& process : processes) {
      while (there_.count(process) == 0) {
        if (Clock::now() > end) throw InputError("rgbdt-" + process + " is not up");
        bus_.Run(100);
      }
    }
  }

  void Run() {
    std::signal(SIGTERM, [](int) { stopped = 1; });
    start_ = Clock::now();
    std::vector<std::thread> threads;
    threads.emplace_back([this] { SendState(); });
    threads.emplace_back([this] { SendClouds(); });
    threads.emplace_back([this] { SendCommands(); });
    for (const CameraSpec& camera : rig_.rig.cameras) {
      threads.emplace_back([this, &camera] { SendImages(camera); });
    }
    std::puts("begun");
    std::fflush(stdout);
    const auto end =
        start_ + duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_));
    while (Clock::now() < end && stopped == 0) bus_.Run(20);
    for (std::thread& thread : threads) thread.join();
    const Clock::time_point quiet = Clock::now() + kLastWords;
    while (Clock::now() < quiet) bus_.Run(20);
  }

  void Write() {
    std::ofstream latency(dir_ + "/latency.csv");
    latency << "second,late_ms,latency_ms\n" << std::fixed;
    for (const Chunk& chunk : chunks_) {
      const std::int64_t sent = chunk.sent_us.load();
      if (sent < 0) continue;
      latency << Seconds(start_) + ToSeconds(sent) << ','
              << 1e-3 * static_cast<double>(chunk.late_us) << ',';
      if (chunk.received_us >= 0) latency << 1e-3 * static_cast<double>(chunk.received_us - sent);
      latency << '\n';
    }
    std::ofstream sent(dir_ + "/sent.csv");
    sent << "channel,messages\n";
    for (const auto& [channel, count] : sent_) sent << channel << ',' << count << '\n';
    sent << "answered," << answered_.size() << '\n';
    if (!latency.flush() || !sent.flush() || !statuses_.flush()) {
      throw InputError("cannot write to " + dir_);
    }
  }

 private:
  Utime SinceStart() const { return duration_cast<microseconds>(Clock::now() - start_).count(); }

  // Calls `send` with the number and the time [us] of each, as soon as that time has come.
  template <typename Send>
  void AtRate(double hz, const Send& send) {
    for (std::int64_t n = 0;; ++n) {
      const Utime t = FromSeconds(static_cast<double>(n) / hz);
      if (ToSeconds(t) >= seconds_) return;
      std::this_thread::sleep_until(start_ + microseconds(t));
      if (stopped != 0) return;
      send(n, t);
    }
  }

  void Publish(const Message& message, LcmBus* bus, std::int64_t* count) {
    bus->Publish(ChannelOf(message), Encode(message));
    ++*count;
  }
  std::int64_t* Count(const std::string& channel) { return &sent_.at(channel); }

  void SendState() {
    LcmBus bus("");
    std::int64_t calibrations = 0;
    AtRate(1, [&](std::int64_t n, Utime) {
      RigText text = rig_.text;
      text.seq = n;
      Publish(text, &bus, Count("RIG"));
      for (Message& message : rig_.Calibrations(kStart)) {
        SetSeq(calibrations++, &message);
        Publish(message, &bus, Count("CALIBRATION"));
      }
    });
  }

  void SendClouds() {
    LcmBus bus("");
    std::vector<CloudChunk> sweep = SweepInChunks();
    AtRate(kSweepsHz * kChunks * load_, [&](std::int64_t n, Utime t) {
      CloudChunk& chunk = sweep[static_cast<std::size_t>(n % kChunks)];
      if (n % kChunks == 0) sweep_utime_ = kStart + t;
      chunk.seq = n;
      chunk.cloud.sweep_utime = sweep_utime_;
      chunk.cloud.utime.assign(chunk.cloud.points.size(), kStart + t);
      if (n >= static_cast<std::int64_t>(chunks_.size())) return;
      Chunk& kept = chunks_[static_cast<std::size_t>(n)];
      const Utime now = SinceStart();
      kept.late_us = now - t;
      kept.sent_us = now;
      Publish(chunk, &bus, Count("CLOUD"));
    });
  }

  // Without a view the solver answers at once.
  void SendCommands() {
    LcmBus bus("");
    AtRate(kCommandsHz, [&](std::int64_t n, Utime t) {
      SessionCommand command;
      command.command = kSessionId + n;
      command.seq = n;
      command.utime = kStart + t;
      command.verb = SessionVerb::kSolve;
      Publish(command, &bus, Count("SESSION_COMMAND"));
    });
  }

  void SendImages(const CameraSpec& camera) {
    LcmBus bus("");
    Image image = PictureOf(camera, kStart, 1);
    std::int64_t* count = Count(ChannelOf(image));
    const double hz = camera.kind == CameraKind::kThermal ? kThermalHz : kColorHz;
    AtRate(hz * load_, [&](std::int64_t n, Utime t) {
      image.utime = kStart + t - FromSeconds(camera.readout_s);
      image.seq = image.frame_number = n;
      Publish(image, &bus, count);
    });
  }

  void Take(const Status& status) {
    there_.insert(status.process);
    const double now = Seconds(Clock::now());
    for (const auto& [name, value] : status.counters) {
      if (name != "received" && name.compare(0, 4, "gaps") != 0) continue;
      statuses_ << now << ',' << status.process << ',' << name << ',' << value << '\n';
    }
  }

  void Take(const RgbdtCloud& cloud) {
    if (cloud.whole_sweep || cloud.utime.empty()) return;
    const double number = ToSeconds(cloud.utime.front() - kStart) * kSweepsHz * kChunks * load_;
    const auto n = static_cast<std::int64_t>(number + 0.5);
    if (n < 0 || n >= static_cast<std::int64_t>(chunks_.size())) return;
    chunks_[static_cast<std::size_t>(n)].received_us = SinceStart();
  }

  void Take(const SessionEvent& event) {
    if (event.source == "solver" && event.command >= kSessionId) answered_.insert(event.command);
  }

  std::map<std::string, std::int64_t> ChannelsSent() const {
    std::map<std::string, std::int64_t> channels = {
        {"RIG", 0}, {"CALIBRATION", 0}, {"CLOUD", 0}, {"SESSION_COMMAND", 0}};
    for (const CameraSpec& camera : rig_.rig.cameras) {
      Image image;
      image.camera = camera.name;
      channels[ChannelOf(image)] = 0;
    }
    return channels;
  }

  double seconds_, load_;
  std::string dir_;
  LcmBus bus_{""};
  BenchRig rig_ = LargeRig();
  std::map<std::string, std::int64_t> sent_ = ChannelsSent();  // a thread a channel
  std::vector<Chunk> chunks_;
  Utime sweep_utime_ = 0;
  std::ofstream statuses_;
  std::set<std::string> there_;
  std::set<std::int64_t> answered_;
  Clock::time_point start_;
};

}  // namespace
}  // namespace rgbdt::bench

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fputs("Usage: soak_rig SECONDS LOAD DIR PROCESS...\n", stderr);
    return 2;
  }
  try {
    rgbdt::bench::Soak soak(std::stod(argv[1]), std::stod(argv[2]), argv[3]);
    soak.WaitFor({argv + 4, argv + argc});
    soak.Run();
    soak.Write();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "soak_rig: %s\n", e.what());
    return 1;
  }
  return 0;
}
