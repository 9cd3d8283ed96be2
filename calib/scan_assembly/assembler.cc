#include "calib/scan_assembly/assembler.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calib/model/errors.h"
#include "calib/scan_assembly/line_to_cloud.h"

namespace rgbdt {
namespace {

Utime EndOf(const LineScan& line) { return line.FiredAt(line.range.size()); }

}  // namespace

void Assembler::SetScanner(const TurnedScanner& scanner) {
  scanner_ = scanner;
  Forget();
}

Assembler::Chunks Assembler::Add(const EncoderReading& as_stamped) {
  const EncoderReading reading = OnTime(scanner_, as_stamped);
  if (reading.utime < track_.newest() - kClockReset) Forget();
  if (!track_.Add(reading)) {
    throw InputError("encoder reading of " + std::to_string(reading.utime) +
                     " us is not after the one before it (" + std::to_string(track_.newest()) +
                     " us)");
  }
  return Drain();
}

Assembler::Chunks Assembler::Add(const LineScan& line) {
  CheckLine(line);
  if (waiting_.size() >= kMaxWaiting) {
    waiting_.erase(waiting_.begin());
    ++counts_.lines_lost;
  }
  waiting_.emplace(line.utime, line);
  return Drain();
}

// What is refused is refused when it comes, so that it costs no other line its place.
void Assembler::CheckLine(const LineScan& line) const {
  const std::string of = "line of " + std::to_string(line.utime) + " us ";
  if (waiting_.count(line.utime) != 0) throw InputError(of + "came twice");
  if (newest_ && line.seq > newest_->seq && line.utime <= newest_->utime) {
    throw InputError(of + "was sent after that of " + std::to_string(newest_->utime) +
                     " us: a clock was set back");
  }
  if (track_.newest() == 0 || line.utime > track_.newest()) return;  // its sweep is not known yet
  if (line.utime < track_.newest() - kKept) {
    throw InputError(of + "is more than 1 s older than the newest encoder reading (" +
                     std::to_string(track_.newest()) + " us)");
  }
  const Utime sweep = SweepOf(line);
  if (sweep != 0 && sweep <= ended_) throw InputError(of + "came after its sweep had ended");
  if (sweep_ && sweep == sweep_->utime && !FitsSweep(line)) {
    throw InputError(of + "has number " + std::to_string(line.seq) +
                     ", which came before or does not fit the sweep that began with number " +
                     std::to_string(sweep_->first_seq));
  }
}

bool Assembler::FitsSweep(const LineScan& line) const {
  const std::int64_t place = line.seq - sweep_->first_seq;
  return place >= 0 && place <= kMaxLines && sweep_->sent.count(static_cast<int>(place)) == 0;
}

// A sweep's name is its start: where the reading at its start is missing, the next one tells.
Utime Assembler::SweepOf(const LineScan& line) const {
  const Utime sweep = track_.SweepAt(line.utime);
  if (sweep != 0) return sweep;
  const Utime next = track_.SweepAt(EndOf(line));
  return StartOf(next) <= line.utime ? next : 0;
}

bool Assembler::IsReady(const LineScan& line) const {
  if (EndOf(line) > track_.newest()) return false;
  const Utime sweep = SweepOf(line);
  const bool first = sweep != 0 && !(sweep_ && sweep_->utime == sweep);
  return !first || FollowsAllBefore(line) || EndOf(line) + kGrace <= track_.newest();
}

// Whether nothing that is still to come can lie before the line, in its sweep or the one before.
bool Assembler::FollowsAllBefore(const LineScan& line) const {
  if (!sweep_) return newest_ && line.seq == newest_->seq + 1;
  return static_cast<int>(sweep_->sent.size()) == sweep_->lines &&
         line.seq == sweep_->first_seq + sweep_->lines;
}

// How many of a sweep's lines were lost before the first that is there, as where this was started
// in the midst of it: as many as fit in since the sweep's start, and no more than numbers are
// missing since `before`, the newest line from before the sweep.
std::int64_t Assembler::LinesLostBefore(const LineScan& first, Utime sweep_utime,
                                        const std::optional<Place>& before) const {
  constexpr double kJitter = 0.1;  // of a line's time, in periods
  const double periods =
      static_cast<double>(first.utime - StartOf(sweep_utime)) / LinePeriodAt(first, before);
  const auto fit = static_cast<std::int64_t>(std::floor(periods + kJitter));
  const bool counted = before && before->utime < StartOf(sweep_utime) && before->seq < first.seq;
  return std::max<std::int64_t>(0, counted ? std::min(fit, first.seq - before->seq - 1) : fit);
}

// From a line to the next [us]: by the lines beside it, or else as long as its beams take.
double Assembler::LinePeriodAt(const LineScan& line, const std::optional<Place>& before) const {
  const auto period = [](const Place& from, const Place& to) {
    const double lines = static_cast<double>(to.seq - from.seq);
    return std::max(1.0, static_cast<double>(to.utime - from.utime) / lines);
  };
  const Place here{line.utime, line.seq};
  for (const auto& [utime, next] : waiting_) {
    if (next.seq > line.seq) return period(here, {utime, next.seq});
  }
  if (before && before->seq < line.seq) return period(*before, here);
  return period(here, {EndOf(line), line.seq + 1});
}

Assembler::Chunks Assembler::Drain() {
  Chunks out;
  while (!waiting_.empty() && IsReady(waiting_.begin()->second)) {
    const LineScan line = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    AddToSweep(line, &out);
  }
  const auto names_it = [&](Utime at) { return track_.SweepAt(at) == sweep_->utime; };
  if (sweep_ && !names_it(track_.newest()) && !names_it(track_.newest() - kGrace)) EndSweep(&out);
  track_.ForgetBefore(track_.newest() - kKept - kGrace);
  return out;
}

void Assembler::AddToSweep(const LineScan& line, Chunks* out) {
  const std::optional<Place> before = newest_;
  if (!newest_ || line.utime > newest_->utime) newest_ = Place{line.utime, line.seq};
  const Utime sweep_utime = SweepOf(line);
  if (sweep_utime == 0) return;
  if (sweep_utime <= ended_) {  // not known yet when the line came
    ++counts_.lines_lost;
    return;
  }
  if (sweep_ && sweep_->utime != sweep_utime) EndSweep(out);
  if (!sweep_) {
    sweep_ = Sweep{sweep_utime, line.seq - LinesLostBefore(line, sweep_utime, before), {}, 0};
  }
  if (!FitsSweep(line)) {
    ++counts_.lines_lost;
    return;
  }
  const int place = static_cast<int>(line.seq - sweep_->first_seq);
  sweep_->lines = std::max(sweep_->lines, place + 1);
  const auto angles = BeamAngles(scanner_, track_, line, kMaxGap);
  if (!angles) return;
  sweep_->sent.insert(place);
  CloudChunk chunk;
  chunk.cloud = LineToCloud(scanner_, line, *angles);
  chunk.cloud.sweep_utime = sweep_utime;
  chunk.cloud.first_line = place;
  out->push_back(std::move(chunk));
  ++counts_.lines_used;
}

void Assembler::EndSweep(Chunks* out) {
  CloudChunk end;
  end.cloud.sweep_utime = sweep_->utime;
  end.sweep_lines = sweep_->lines;
  end.cloud.first_line = end.sweep_lines;
  end.sweep_end = true;
  end.lines_lost = end.sweep_lines - static_cast<int>(sweep_->sent.size());
  counts_.lines_lost += end.lines_lost;
  out->push_back(std::move(end));
  ended_ = sweep_->utime;
  sweep_.reset();
  ++counts_.sweeps;
}

void Assembler::Forget() {
  track_ = {};
  waiting_.clear();
  sweep_.reset();
  ended_ = 0;
  newest_.reset();
}

std::optional<std::size_t> Assembler::LinesOfSweep() const {
  if (!sweep_) return std::nullopt;
  return sweep_->sent.size();
}

}  // namespace rgbdt
