#include "services/drivers/ouster/ouster_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kFrames = 65536;  // their numbers wrap
constexpr int kMostLate = 100;  // farther back: the sensor was started anew
constexpr std::int64_t kSince1970_ns =
    1'000'000'000'000'000'000;  // a clock that shows 2001 or later

}  // namespace

OusterSweeps::OusterSweeps(ouster::Metadata metadata) : metadata_(std::move(metadata)) {
  for (int row = 0; row < metadata_.rows; ++row) {
    for (int column = 0; column < metadata_.columns_per_frame; ++column) {
      beams_.push_back(ouster::BeamOf(metadata_, row, column));
    }
  }
  // Beams begin on a circle of some millimetres about the axis.
  const auto rows = static_cast<std::size_t>(metadata_.rows);
  const auto columns = static_cast<std::size_t>(metadata_.columns_per_frame);
  for (std::size_t line = 0; line < rows; ++line) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const std::size_t first = (rows - 1 - line) * columns;
    for (std::size_t i = first; i < first + columns; ++i) mean += beams_[i].origin_m;
    origins_.emplace_back((mean / static_cast<double>(columns)).cast<float>());
  }
}

bool OusterSweeps::IsLate(int frame) const {
  if (!frame_) return false;
  const int behind = (*frame_ - frame + kFrames) % kFrames;
  return behind > 0 && behind <= kMostLate;
}

// A packet arrives once its last column was measured. What PTP is ahead of UTC is kept, so that a
// packet that comes late has the times of those before it.
void OusterSweeps::FollowClock(const ouster::Packet& packet, Utime arrival) {
  const auto last = std::find_if(packet.columns.rbegin(), packet.columns.rend(),
                                 [](const ouster::Column& column) { return column.valid; });
  if (last == packet.columns.rend()) return;
  if (last->time_ns < kSince1970_ns) {
    const bool stepped = !fit_.Add(last->time_ns, arrival);
    if (stepped || !turn_has_fit_) fit_of_turn_ = fit_;
    turn_has_fit_ = true;
  } else if (const auto utc = PtpToUtc(last->time_ns / 1000, arrival)) {
    ahead_ = last->time_ns / 1000 - *utc;
  }
}

Utime OusterSweeps::TimeOf(std::int64_t time_ns) const {
  if (time_ns >= kSince1970_ns) return time_ns / 1000 - ahead_;
  return fit_of_turn_.ToHost(static_cast<double>(time_ns)).value_or(time_ns / 1000);
}

void OusterSweeps::Begin(int frame) {
  first_ = !frame_.has_value();
  frame_ = frame;
  turn_has_fit_ = false;
  const auto columns = static_cast<std::size_t>(metadata_.columns_per_frame);
  const std::size_t size = static_cast<std::size_t>(metadata_.rows) * columns;
  came_.assign(columns, false);
  times_.assign(columns, 0);
  cloud_ = Cloud();
  cloud_.lines = metadata_.rows;
  cloud_.beams = metadata_.columns_per_frame;
  cloud_.points.assign(size, {kNan, kNan, kNan});
  cloud_.directions.assign(size, {kNan, kNan, kNan});
  cloud_.intensity.assign(size, kNan);
  cloud_.utime.assign(size, 0);
  cloud_.ring.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    cloud_.ring[i] = static_cast<std::uint16_t>(i / columns);
  }
  cloud_.origins = origins_;
}

void OusterSweeps::Put(const ouster::Column& column, Utime utime) {
  const auto columns = static_cast<std::size_t>(metadata_.columns_per_frame);
  const auto rows = static_cast<std::size_t>(metadata_.rows);
  const auto place = static_cast<std::size_t>(column.measurement);
  came_[place] = true;
  times_[place] = utime;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto shift = static_cast<std::int64_t>(metadata_.pixel_shift[row]);
    const auto n = static_cast<std::int64_t>(columns);
    const auto beam =
        static_cast<std::size_t>(((static_cast<std::int64_t>(place) + shift) % n + n) % n);
    const std::size_t i = (rows - 1 - row) * columns + beam;
    const ouster::Beam& ray = beams_[row * columns + place];
    const bool second = column.returns[row].range_mm == 0 && !column.second_returns.empty();
    const ouster::Return& back = second ? column.second_returns[row] : column.returns[row];
    cloud_.utime[i] = utime;
    cloud_.directions[i] = ray.direction.cast<float>();
    cloud_.intensity[i] = static_cast<float>(back.reflectivity) / 255;
    if (back.range_mm == 0) continue;
    cloud_.points[i] = (ray.origin_m + 1e-3 * back.range_mm * ray.direction).cast<float>();
  }
}

std::optional<Cloud> OusterSweeps::Add(const ouster::Packet& packet, Utime arrival) {
  if (IsLate(packet.frame)) return std::nullopt;
  std::optional<Cloud> done;
  if (!frame_ || *frame_ != packet.frame) {
    if (frame_ && (!first_ || came_.front())) done = Take();
    Begin(packet.frame);
  }
  FollowClock(packet, arrival);
  for (const ouster::Column& column : packet.columns) {
    if (column.valid) Put(column, TimeOf(column.time_ns));
  }
  return done;
}

std::optional<Cloud> OusterSweeps::Finish() {
  if (!frame_ || !came_.back() || (first_ && !came_.front())) return std::nullopt;
  frame_.reset();
  return Take();
}

Utime OusterSweeps::begun() const {
  const auto first = std::find(came_.begin(), came_.end(), true);
  return first == came_.end() ? 0 : times_[static_cast<std::size_t>(first - came_.begin())];
}

// Columns that never came have the time of the last one before them.
std::optional<Cloud> OusterSweeps::Take() {
  cloud_.sweep_utime = begun();
  if (cloud_.sweep_utime == 0) return std::nullopt;
  lost_columns_ += std::count(came_.begin(), came_.end(), false);
  const auto columns = came_.size();
  for (std::size_t i = 0; i < cloud_.utime.size(); ++i) {
    if (cloud_.utime[i] != 0) continue;
    cloud_.utime[i] = i % columns == 0 ? cloud_.sweep_utime : cloud_.utime[i - 1];
  }
  return std::move(cloud_);
}

}  // namespace rgbdt
