// How long messages take on the bus: bus_pulse CSV. Publishes a thousand small ones a second on
// LCM_DEFAULT_URL until SIGTERM; then CSV has a line for each that came: when it was sent [s,
// monotonic clock], how long until its handler was called [ms].
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t stopped = 0;

// From before a message is published until its handler is called, through the kernel.
void Pulse(const std::string& path) {
  std::signal(SIGTERM, [](int) { stopped = 1; });
  const auto now_us = [] {
    return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
        .count();
  };
  std::vector<std::pair<std::int64_t, std::int64_t>> taken;  // when, how long [us]
  LcmBus receiver("");
  receiver.Subscribe("ENCODER",
                     [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                       const auto reading = std::get<EncoderReading>(Decode(channel, data, size));
                       taken.emplace_back(reading.ticks, now_us() - reading.ticks);
                     });
  std::thread sender([&] {
    LcmBus bus("");
    EncoderReading reading;
    reading.utime = 1;
    for (Clock::time_point next = Clock::now(); stopped == 0;) {
      std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
      reading.ticks = now_us();
      bus.Publish("ENCODER", Encode(reading));
      ++reading.seq;
    }
  });
  while (stopped == 0) receiver.Run(100);
  sender.join();
  std::ofstream csv(path);
  for (const auto& [when, us] : taken) {
    csv << std::to_string(1e-6 * static_cast<double>(when)) << ',' << 1e-3 * static_cast<double>(us)
        << '\n';
  }
  if (!csv.flush()) throw InputError("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    rgbdt::Pulse(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bus_pulse: %s\n", e.what());
    return 1;
  }
  return 0;
}
