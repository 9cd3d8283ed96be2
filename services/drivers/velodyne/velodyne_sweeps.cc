#include "services/drivers/velodyne/velodyne_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

using velodyne::Packet;
using velodyne::Return;

constexpr double kDegree = M_PI / 180;
constexpr double kSeamDeg = 180;
constexpr double kMostFilledS = 0.5;  // a longer gap ends the revolution
constexpr int kStandsStill = 3;       // packets with one and the same time
constexpr std::int64_t kMostLateUs = 1'000'000;
constexpr std::size_t kMaxColumns = 20'000;  // a head that hardly turns

// From the seam on, 0 to 360.
double FromSeam(double azimuth_deg) { return std::fmod(azimuth_deg + 720 - kSeamDeg, 360); }

}  // namespace

VelodyneSweeps::VelodyneSweeps(VelodyneDevice::Model model) : sensor_(velodyne::SensorOf(model)) {
  for (int laser = 0; laser < sensor_.lasers(); ++laser) {
    const double elevation = sensor_.elevation_deg[static_cast<std::size_t>(laser)] * kDegree;
    cos_elevation_.push_back(std::cos(elevation));
    sin_elevation_.push_back(std::sin(elevation));
    laser_us_.push_back(sensor_.LaserTime_us(laser));
  }
}

double VelodyneSweeps::PacketDuration_us(const Packet& packet) const {
  return static_cast<double>(packet.columns.size()) * sensor_.column_us;
}

// Came before, or after a later one. Of a clock that stands still, no packet is.
bool VelodyneSweeps::IsOldNews(std::int64_t stamp) {
  if (!last_stamp_) return false;
  same_stamps_ = stamp == *last_stamp_ ? same_stamps_ + 1 : 0;
  if (stamp == *last_stamp_) return same_stamps_ < kStandsStill;
  return stamp < *last_stamp_ && stamp > *last_stamp_ - kMostLateUs;
}

// The stamp is of the packet's first firing.
void VelodyneSweeps::FollowClock(const Packet& packet, std::int64_t stamp, Utime arrival) {
  const auto duration = static_cast<Utime>(PacketDuration_us(packet));
  standing_.reset();
  if (same_stamps_ >= kStandsStill) {
    standing_ = arrival - duration - stamp;
  } else if (!fit_.Add(stamp, arrival, duration)) {
    ++clock_steps_;
    last_stamp_.reset();
    fit_of_turn_ = fit_;
  }
}

Utime VelodyneSweeps::TimeOf(double stamp_us) const {
  if (standing_) return *standing_ + std::llround(stamp_us);
  return fit_of_turn_.ToHost(stamp_us).value();
}

std::vector<Cloud> VelodyneSweeps::Add(const Packet& packet, Utime arrival) {
  std::vector<Cloud> done;
  const std::int64_t stamp = counter_.Unwrap(packet.stamp_us);
  if (IsOldNews(stamp)) return done;
  FollowClock(packet, stamp, arrival);
  FillGap(packet, stamp, &done);
  last_stamp_ = stamp;
  for (const velodyne::Column& column : packet.columns) {
    Push({column.azimuth_deg, column.step_deg, static_cast<double>(stamp) + column.time_us, 0,
          column.returns},
         &done);
  }
  return done;
}

// Columns of packets that were lost, from the sensor's own times: they keep their places.
void VelodyneSweeps::FillGap(const Packet& packet, std::int64_t stamp, std::vector<Cloud>* done) {
  if (!last_stamp_ || !last_column_ || packet.columns.empty()) return;
  const double duration = PacketDuration_us(packet);
  const auto passed = static_cast<double>(stamp - *last_stamp_);
  const std::int64_t lost = std::llround(passed / duration) - 1;
  if (lost <= 0) return;
  lost_packets_ += lost;
  if (passed > kMostFilledS * 1e6) {
    columns_.clear();
    whole_ = false;
    last_column_.reset();
    return;
  }
  const FiredColumn last = *last_column_;
  const std::int64_t count = lost * static_cast<std::int64_t>(packet.columns.size());
  // It turned as often as its last step says, to the azimuth where it is seen again.
  const double rough = last.step_deg * static_cast<double>(count + 1);
  const double to = packet.columns.front().azimuth_deg - last.azimuth_deg;
  const double turn = to + 360 * std::round((rough - to) / 360);
  const double step = turn / static_cast<double>(count + 1);
  for (std::int64_t i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count + 1);
    FiredColumn column;
    column.azimuth_deg = std::fmod(last.azimuth_deg + step * static_cast<double>(i) + 720, 360);
    column.step_deg = step;
    column.stamp_us = last.stamp_us + share * (static_cast<double>(stamp) - last.stamp_us);
    Push(std::move(column), done);
  }
}

void VelodyneSweeps::Push(FiredColumn column, std::vector<Cloud>* done) {
  const bool wraps =
      last_column_ && FromSeam(column.azimuth_deg) < FromSeam(last_column_->azimuth_deg) - kSeamDeg;
  if (wraps) {
    if (whole_ && columns_.size() > 1) done->push_back(Revolution());
    columns_.clear();
    whole_ = true;
    fit_of_turn_ = fit_;
    begun_ = TimeOf(column.stamp_us);
  } else if (columns_.size() >= kMaxColumns) {
    columns_.clear();
    whole_ = false;
  }
  last_column_ = column;
  last_column_->returns.clear();
  if (!whole_) return;
  column.utime = TimeOf(column.stamp_us);
  columns_.push_back(std::move(column));
}

void VelodyneSweeps::FillBeam(const FiredColumn& column, std::size_t laser, std::size_t i,
                              Cloud* cloud) const {
  cloud->utime[i] = column.utime + static_cast<Utime>(std::llround(laser_us_[laser]));
  if (column.returns.empty()) return;
  // Clockwise from above, as the head turns: an angle from x towards y is its negative.
  const double azimuth = (column.azimuth_deg + sensor_.azimuth_deg[laser] +
                          column.step_deg * laser_us_[laser] / sensor_.column_us) *
                         kDegree;
  const Eigen::Vector3d direction(cos_elevation_[laser] * std::cos(azimuth),
                                  -cos_elevation_[laser] * std::sin(azimuth),
                                  sin_elevation_[laser]);
  const Return& back = column.returns[laser];
  cloud->directions[i] = direction.cast<float>();
  cloud->intensity[i] = static_cast<float>(back.reflectivity) / 255;
  if (back.distance > 0) {
    cloud->points[i] = (back.distance * sensor_.unit_m * direction).cast<float>();
  }
}

Cloud VelodyneSweeps::Revolution() const {
  const auto lasers = static_cast<std::size_t>(sensor_.lasers());
  const std::size_t beams = columns_.size();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Cloud cloud;
  cloud.sweep_utime = columns_.front().utime;
  cloud.lines = sensor_.lasers();
  cloud.beams = static_cast<int>(beams);
  cloud.points.assign(lasers * beams, {kNan, kNan, kNan});
  cloud.directions.assign(lasers * beams, {kNan, kNan, kNan});
  cloud.intensity.assign(lasers * beams, kNan);
  cloud.utime.resize(lasers * beams);
  cloud.ring.resize(lasers * beams);
  const double covered =
      FromSeam(columns_.back().azimuth_deg) - FromSeam(columns_.front().azimuth_deg);
  const double step = covered / static_cast<double>(beams - 1);
  for (std::size_t laser = 0; laser < lasers; ++laser) {
    const auto ring = static_cast<std::size_t>(sensor_.ring[laser]);
    const auto n = static_cast<std::int64_t>(std::max<std::size_t>(beams, 1));
    const auto aside = step > 0 ? std::llround(sensor_.azimuth_deg[laser] / step) % n : 0;
    for (std::size_t c = 0; c < beams; ++c) {
      const auto place = static_cast<std::size_t>((static_cast<std::int64_t>(c) + aside + n) % n);
      const std::size_t i = ring * beams + place;
      cloud.ring[i] = static_cast<std::uint16_t>(ring);
      FillBeam(columns_[c], laser, i, &cloud);
    }
  }
  return cloud;
}

}  // namespace rgbdt
