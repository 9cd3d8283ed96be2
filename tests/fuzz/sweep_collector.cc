// Chunks of sweeps as they come over the bus, decoded, in any order: collected and joined. Of each
// the input says all but its points; and before them whether large sweeps are joined, too, which
// takes its time.
#include "calib/scan_assembly/sweep_collector.h"

#include <algorithm>
#include <map>
#include <utility>

#include "calib/scan_assembly/sweep_chunks.h"
#include "services/messages/limits.h"
#include "tests/fuzz/sweep_check.h"

namespace rgbdt {
namespace {

constexpr unsigned kSweeps = 4;  // their names
enum Flag : unsigned { kOrganised = 4, kEnd = 8, kFar = 16, kLong = 32, kWide = 64 };
constexpr unsigned kJoinsLarge = 0x7f;
constexpr std::int64_t kLarge = 100'000;  // points
constexpr int kMostPoints = 200'000;      // that come, of all sweeps
constexpr std::size_t kSmall = 10'000;    // of a sweep that is sent on

int Count(unsigned value, bool large) {
  return std::min(static_cast<int>(value) * (large ? 16 : 1), static_cast<int>(kMaxLines));
}

// As the codec lets one pass.
CloudChunk TakeChunk(fuzz::Input* input) {
  constexpr int kMostWide = 5000;
  const unsigned flags = input->Byte(), vectors = input->Byte();
  CloudChunk chunk;
  Cloud& cloud = chunk.cloud;
  cloud.sweep_utime = 1'700'000'000'000'000 + flags % kSweeps;
  cloud.organised = (flags & kOrganised) != 0;
  chunk.sweep_end = (flags & kEnd) != 0;
  cloud.first_line = Count(input->Word(), (flags & kFar) != 0);
  chunk.sweep_lines = Count(input->Word(), (flags & kLong) != 0);
  cloud.lines = input->Byte() % (cloud.organised ? 8 : 2);
  cloud.beams = Count(input->Word(), (flags & kWide) != 0);
  if (cloud.lines > 0) cloud.beams = 1 + cloud.beams % kMostWide;
  const std::size_t size =
      static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.assign(size, {1, 2, 3});
  if ((vectors & 1) != 0) cloud.directions.assign(size, {1, 0, 0});
  if ((vectors & 2) != 0) cloud.origins.resize(static_cast<std::size_t>(cloud.lines), {0, 0, 1});
  if ((vectors & 4) != 0) cloud.intensity.assign(size, 0.5F);
  if ((vectors & 8) != 0) cloud.utime.assign(size, cloud.sweep_utime);
  if ((vectors & 16) != 0) cloud.ring.assign(size, 7);
  return chunk;
}

// What was joined is a sweep as a driver's: sent on, it is the same again.
void SendOn(const Cloud& sweep) {
  SweepCollector sweeps;
  for (CloudChunk& chunk : SplitSweep(sweep)) sweeps.Add(std::move(chunk));
  const std::optional<Cloud> again = sweeps.Complete(sweep.sweep_utime);
  fuzz::Require(again.has_value() && again->lines == sweep.lines && again->beams == sweep.beams,
                "a sweep of the same lines and beams");
}

void CheckEnded(const SweepCollector& sweeps, Utime name) {
  try {
    const std::optional<Cloud> cloud = sweeps.Complete(name);
    fuzz::Require(cloud.has_value(), "a sweep that has ended");
    fuzz::Require(cloud->size() <= SweepCollector::kMaxPoints, "no more points than are kept");
    if (cloud->size() > 0) fuzz::RequireWhole(*cloud);
    if (cloud->size() > 0 && cloud->size() < kSmall) SendOn(*cloud);
    fuzz::Require(sweeps.WhyTorn(name).find('\n') == std::string::npos, "one line");
  } catch (const InputError& error) {
    fuzz::Require(false, std::string("what was taken to be joined; ") + error.what());
  }
}

void TakeInput(fuzz::Input input) {
  SweepCollector sweeps;
  struct Reach {
    int lines = 0, beams = 0;
    bool IsLarge() const { return std::int64_t{lines} * beams > kLarge; }
  };
  std::map<Utime, Reach> reach;
  int points = 0;
  const bool joins_large = input.Byte() == kJoinsLarge;
  while (!input.empty() && points < kMostPoints) {
    const CloudChunk chunk = TakeChunk(&input);
    points += static_cast<int>(chunk.cloud.size());
    fuzz::Try([&] {
      sweeps.Add(chunk);
      const Cloud& cloud = chunk.cloud;
      Reach& of_sweep = reach[cloud.sweep_utime];
      of_sweep.lines =
          std::max({of_sweep.lines, chunk.sweep_lines, cloud.first_line + cloud.lines});
      of_sweep.beams = std::max(of_sweep.beams, cloud.size() > 0 ? cloud.beams : 0);
    });
  }
  for (const auto& [name, most] : reach) {
    if (!sweeps.Ended(name)) continue;
    if (most.IsLarge() && !joins_large) continue;
    CheckEnded(sweeps, name);
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput({data, size});
  return 0;
}
