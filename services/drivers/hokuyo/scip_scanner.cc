#include "services/drivers/hokuyo/scip_scanner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

constexpr int kConnectMs = 2000;
constexpr int kReplyMs = 1000;
constexpr int kSilenceMs = 1000;  // without scans; a turn takes 25 to 100 ms
constexpr int kSliceMs = 50;      // how soon a stop is seen
constexpr int kTimesAsked = 10;

using Clock = std::chrono::steady_clock;

}  // namespace

LineScan ToLineScan(const scip::Parameters& scanner, const scip::Scan& scan,
                    Utime utime_of_step_0) {
  LineScan line;
  line.beam_period_s = scanner.beam_period_s();
  line.utime = utime_of_step_0 + FromSeconds(scan.first_step * line.beam_period_s);
  line.angle_step_rad = scanner.step_rad();
  line.first_angle_rad = (scan.first_step - scanner.front_step) * line.angle_step_rad;
  line.range.reserve(scan.range_mm.size());
  for (const std::uint32_t mm : scan.range_mm) {
    const auto least = static_cast<std::uint32_t>(std::max(scanner.least_mm, 1));
    const bool hit = mm >= least && mm <= static_cast<std::uint32_t>(scanner.most_mm);
    line.range.push_back(hit ? 0.001F * static_cast<float>(mm)
                             : std::numeric_limits<float>::quiet_NaN());
  }
  for (const std::uint32_t value : scan.intensity) {
    line.intensity.push_back(std::min(1.0F, static_cast<float>(value) / kScipFullIntensity));
  }
  return line;
}

struct ScipScanner::Connection {
  Connection(DeviceThread& device_thread, const HokuyoDevice& device)
      : thread(device_thread), link(device.address, device.port, kConnectMs) {}

  [[noreturn]] void Fail(const std::string& what) const {
    throw DeviceError(link.name() + ": " + what);
  }

  DeviceThread& thread;
  TcpLink link;
  scip::BlockReader reader;
  scip::Parameters scanner;
  std::optional<ScipClock> clock;
  std::optional<std::int64_t> last_ms;  // of a scan, on the scanner's clock
};

void ScipScanner::Serve(DeviceThread& thread) {
  report_.Set("connects to " + device_.address + ":" + std::to_string(device_.port), false);
  try {
    Connection c(thread, device_);
    Greet(c);
    AlignClock(c);
    Start(c);
    Stream(c);
    if (thread.Stopping()) c.link.Send(scip::kQuit);
  } catch (const std::exception& e) {
    report_.Set(std::string("tries again: ") + e.what(), false);
    throw;
  }
}

// The reply with this echo; others (scans of before) are passed over.
std::optional<scip::Block> ScipScanner::WaitForReply(Connection& c, std::string_view echo,
                                                     int timeout_ms) {
  const auto until = Clock::now() + std::chrono::milliseconds(timeout_ms);
  while (!c.thread.Stopping() && Clock::now() < until) {
    while (auto block = c.reader.Take()) {
      if (block->echo() == echo) return block;
    }
    c.reader.Append(c.link.Receive(kSliceMs));
  }
  return std::nullopt;
}

scip::Block ScipScanner::Ask(Connection& c, std::string_view command) {
  const std::string_view echo = command.substr(0, command.size() - 1);
  c.link.Send(command);
  auto reply = WaitForReply(c, echo, kReplyMs);
  if (!reply) {
    c.Fail("no answer to " + std::string(echo) +
           " for a second; is it a scanner with SCIP 2.0, and no other program connected to it?");
  }
  return *std::move(reply);
}

void ScipScanner::Greet(Connection& c) {
  // It may have been left in its time mode, in which it takes nothing else.
  c.link.Send(scip::kTimeModeOff);
  Ask(c, scip::kQuit);
  Ask(c, scip::kUseScip2);  // older scanners need it; others refuse it, which says nothing
  Ask(c, scip::kVersion);
  try {
    c.scanner = scip::ParseParameters(Ask(c, scip::kParameters));
  } catch (const InputError& e) {
    c.Fail(e.what());
  }
}

// The laser is off meanwhile. A scanner that has no such mode is timed by its scans alone.
void ScipScanner::AlignClock(Connection& c) {
  const double scan_s = c.scanner.last_step * c.scanner.beam_period_s();
  c.clock.emplace(FromSeconds(scan_s));
  const scip::Block on = Ask(c, scip::kTimeModeOn);
  if (on.status() != "00" && on.status() != "02") {
    c.thread.Warn(c.link.name() + ": does not tell its time (" +
                  scip::StatusText("TM0", on.status()) + "); lines may bear times some ms late");
    return;
  }
  for (int i = 0; i < kTimesAsked; ++i) {
    const Utime sent = SteadyUtime();
    const scip::Block reply = Ask(c, scip::kTime);
    try {
      c.clock->AddTime(scip::ParseTime(reply), c.link.arrival(), c.link.steady_arrival() - sent);
    } catch (const InputError&) {
      report_.Count("bad replies");
    }
  }
  Ask(c, scip::kTimeModeOff);
}

void ScipScanner::Start(Connection& c) {
  for (const bool intensities : {true, false}) {
    const std::string command =
        scip::MeasureCommand(intensities, c.scanner.first_step, c.scanner.last_step);
    const scip::Block reply = Ask(c, command);
    if (reply.status() == "00") return;
    if (!intensities) c.Fail("measures nothing: " + scip::StatusText(command, reply.status()));
  }
}

void ScipScanner::Stream(Connection& c) {
  auto last_scan = Clock::now();
  while (!c.thread.Stopping()) {
    c.reader.Append(c.link.Receive(kSliceMs));
    while (const auto block = c.reader.Take()) {
      if (!scip::IsScan(*block)) {
        c.thread.Warn(c.link.name() + ": " + scip::StatusText(block->echo(), block->status()));
        continue;
      }
      OnScan(c, *block, c.link.arrival());
      last_scan = Clock::now();
    }
    if (Clock::now() - last_scan > std::chrono::milliseconds(kSilenceMs)) {
      c.Fail("sends no scans for a second; look at its lamps and its cable");
    }
  }
}

void ScipScanner::OnScan(Connection& c, const scip::Block& block, Utime arrival) {
  scip::Scan scan;
  try {
    scan = scip::ParseScan(block);
    if (scan.first_step != c.scanner.first_step || scan.last_step != c.scanner.last_step) {
      throw InputError("SCIP: a scan has steps " + std::to_string(scan.first_step) + " to " +
                       std::to_string(scan.last_step) + ", which nobody asked for");
    }
  } catch (const InputError& e) {
    report_.Count("bad lines");
    c.thread.Warn(c.link.name() + ": " + e.what());
    return;
  }
  const ScipClock::ScanTime time = c.clock->AddScan(scan.time_ms, arrival);
  if (time.was_set) {
    c.last_ms.reset();
    c.thread.Warn(c.link.name() +
                  ": its clock or this machine's was set; the lines' times begin anew");
  }
  const double turns =
      c.last_ms ? static_cast<double>(time.ms - *c.last_ms) * c.scanner.rpm / 60e3 : 1;
  const std::int64_t lost = std::llround(turns) - 1;
  if (lost > 0) report_.Count("lost lines", lost);
  c.last_ms = time.ms;
  TellGap(c);
  c.thread.Publish(ToLineScan(c.scanner, scan, time.utime));
  report_.Count("lines");
}

// The first line of a connection says what was missed since the one before.
void ScipScanner::TellGap(Connection& c) {
  const std::optional<Utime> before = std::exchange(last_line_, c.link.steady_arrival());
  if (report_.GetStatus().ready) return;
  if (before) {
    c.thread.Warn(c.link.name() +
                  Format(": is back; no lines for %.1f s", ToSeconds(*last_line_ - *before)));
    report_.Count("reconnects");
  }
  report_.Set(c.scanner.model + " at " + c.link.name(), true);
}

}  // namespace rgbdt
