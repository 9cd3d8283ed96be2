// A scanner of your own for rgbdt: publishes lines on LINE_SCAN until it is stopped. From the
// repository's root:
//   lcm-gen --cpp --cpp-hpath out/types lcmtypes/line_scan_t.lcm
//   g++ -std=c++17 -I out/types -o out/publish_line_scan scripts/examples/publish_line_scan.cc
//   -llcm out/publish_line_scan
#include <chrono>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <thread>

#include "rgbdt/line_scan_t.hpp"

int main() {
  lcm::LCM lcm;  // LCM_DEFAULT_URL says which bus
  if (!lcm.good()) return 1;
  constexpr int kBeams = 1081;
  rgbdt::line_scan_t line{};
  line.beam_period_s = 0.025 / 1440;      // 40 turns a second, 1440 steps each
  line.angle_step_rad = 2 * M_PI / 1440;  // against the clock, seen from above
  line.first_angle_rad = -540 * line.angle_step_rad;
  line.num_beams = kBeams;
  line.range_m.resize(kBeams);
  line.intensity.resize(kBeams);
  while (true) {
    // The first beam's time, of a clock that the cameras' times share [us, UTC]. Yours comes from
    // the device; this one takes the machine's and then waits for the turn to end.
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    line.utime = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
    for (int i = 0; i < kBeams; ++i) {
      const double angle = line.first_angle_rad + i * line.angle_step_rad;
      const bool hit = std::cos(angle) > 0.2;  // a wall 3 m ahead; nothing at the sides
      line.range_m[i] =
          hit ? static_cast<float>(3 / std::cos(angle)) : std::numeric_limits<float>::quiet_NaN();
      line.intensity[i] = hit ? 0.5F : std::numeric_limits<float>::quiet_NaN();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
    lcm.publish("LINE_SCAN", &line);
    ++line.seq;
  }
}
