#include "calib/detect/cloud/scattered_crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kMergeM = 0.5;   // farther behind than this, returns do not merge
constexpr double kReachM = 0.15;  // of a side: what farther out or in says nothing of it

enum class Label : std::uint8_t { kOn, kMerged, kFar, kBefore };

// A point where its beam meets the plane: along a side, and outwards of it.
struct Met {
  double along = 0, outwards = 0;
  Label label = Label::kOn;
  std::size_t index = 0;
};

struct Meeting {
  Eigen::Vector3d direction;
  double range = 0;
  Eigen::Vector2d flat;
};

std::optional<Meeting> Meet(const Eigen::Vector3d& point, const Plane& plane,
                            const PlaneFrame& frame) {
  const double norm = point.norm();
  if (!(norm > 0.1)) return std::nullopt;
  const Eigen::Vector3d direction = point / norm;
  const double towards = plane.normal.dot(direction);
  if (!(towards < -0.02)) return std::nullopt;
  const double range = plane.offset / towards;
  return Meeting{direction, range, frame.Flat(range * direction)};
}

// How far places on a board are from the next point, along a strip.
struct Recurrence {
  double mean = 0, variance = 0;
};

class Gaps {
 public:
  void Add(double gap) {
    one_ += gap;
    two_ += gap * gap;
    three_ += gap * gap * gap;
    ++count_;
  }
  std::optional<Recurrence> Get() const {
    constexpr int kLeast = 20;
    if (count_ < kLeast || !(one_ > 0)) return std::nullopt;
    const double mean = two_ / (2 * one_);
    return Recurrence{mean, std::max(0.0, three_ / (3 * one_) - mean * mean)};
  }

 private:
  double one_ = 0, two_ = 0, three_ = 0;
  int count_ = 0;
};

struct Span {
  double low = 0, high = 0;
  std::optional<Label> beyond;  // of what lies at `high`; none: nothing returned
  std::size_t at = 0;           // index of the point at `low`
};

// Where the fewest points are on the wrong side. `strip` is sorted outwards.
std::optional<Span> Split(const std::vector<Met>& strip) {
  int wrong = 0;  // were the side before all of them
  for (const Met& m : strip) wrong += m.label == Label::kOn ? 1 : 0;
  const int all_on = wrong;
  if (all_on == 0) return std::nullopt;
  int least = wrong;
  std::size_t best = 0;  // the side lies behind so many
  for (std::size_t i = 0; i < strip.size(); ++i) {
    wrong += strip[i].label == Label::kOn ? -1 : 1;
    if (wrong < least) {
      least = wrong;
      best = i + 1;
    }
  }
  if (best == 0) return std::nullopt;  // most of it is something else
  Span span;
  span.low = strip[best - 1].outwards;
  span.at = strip[best - 1].index;
  span.high = span.low;
  if (best == strip.size()) return span;
  span.high = strip[best].outwards;
  span.beyond = strip[best].label;
  return span;
}

// Of side 0 to 3, as rectangle_fit.h counts them.
Eigen::Vector2d OutwardOf(const FlatRectangle& rectangle, int side) {
  const double turn = rectangle.angle_rad + (side - 1) * M_PI / 2;
  return {std::cos(turn), std::sin(turn)};
}

class SideCutter {
 public:
  SideCutter(const Cloud& cloud, const Plane& plane, const PlaneFrame& frame,
             const FlatRectangle& near, const Target& target, double sigma_m)
      : cloud_(cloud), plane_(plane), frame_(frame), near_(near), target_(target) {
    const double tolerance = std::max(0.03, 3.5 * sigma_m);
    const double reach = 0.5 * std::hypot(target.width_m, target.height_m) + 2 * kReachM;
    int inside = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const Eigen::Vector3d point = cloud.points[i].cast<double>();
      const auto met = Meet(point, plane, frame);
      if (!met || (met->flat - near.centre).squaredNorm() > reach * reach) continue;
      const double behind = point.norm() - met->range;
      const Label label = std::abs(plane.Signed(point)) <= tolerance ? Label::kOn
                          : behind < 0                               ? Label::kBefore
                          : behind > kMergeM                         ? Label::kFar
                                                                     : Label::kMerged;
      points_.push_back({met->flat, label, i});
      if (label == Label::kOn && IsInside(met->flat)) ++inside;
    }
    spacing_ = std::sqrt(target.width_m * target.height_m / std::max(1, inside));
  }

  void Cut(int side, std::vector<FlatCrossing>* crossings) const {
    const Eigen::Vector2d outward = OutwardOf(near_, side);
    const Eigen::Vector2d along(-outward.y(), outward.x());
    const bool upright = side % 2 == 1;
    const double half = (upright ? target_.width_m : target_.height_m) / 2;
    const double length = upright ? target_.height_m : target_.width_m;
    const double margin = std::min(spacing_, length / 8);  // a corner is of either side
    const double usable = length - 2 * margin;
    const auto count =
        static_cast<std::size_t>(std::max(1.0, std::floor(usable / (1.5 * spacing_))));
    const double width = usable / static_cast<double>(count);
    std::vector<std::vector<Met>> strips(count);
    for (const Flat& p : points_) {
      const Eigen::Vector2d d = p.flat - near_.centre;
      const double place = along.dot(d) + usable / 2;
      const double outwards = outward.dot(d) - half;
      if (place < 0 || place >= usable || outwards > kReachM || outwards < -2 * half) continue;
      const auto strip = std::min(count - 1, static_cast<std::size_t>(place / width));
      strips[strip].push_back({along.dot(d), outwards, p.label, p.index});
    }
    Gaps gaps;
    for (std::vector<Met>& strip : strips) {
      std::sort(strip.begin(), strip.end(),
                [](const Met& a, const Met& b) { return a.outwards < b.outwards; });
      AddGaps(strip, &gaps);
    }
    const auto recurrence = gaps.Get();
    if (!recurrence) return;
    for (std::vector<Met>& strip : strips) {
      if (const auto span = LookAt(&strip)) {
        Add(*span, *recurrence, outward, half, width, crossings);
      }
    }
  }

 private:
  struct Flat {
    Eigen::Vector2d flat;
    Label label;
    std::size_t index;
  };

  bool IsInside(const Eigen::Vector2d& flat) const {
    const Eigen::Vector2d x(std::cos(near_.angle_rad), std::sin(near_.angle_rad));
    const Eigen::Vector2d d = flat - near_.centre;
    return std::abs(x.dot(d)) < target_.width_m / 2 &&
           std::abs(x.x() * d.y() - x.y() * d.x()) < target_.height_m / 2;
  }

  // Of points well on the board.
  static void AddGaps(const std::vector<Met>& strip, Gaps* gaps) {
    const Met* last = nullptr;
    for (const Met& m : strip) {
      if (m.label != Label::kOn || m.outwards > -0.02) continue;
      if (last != nullptr) gaps->Add(m.outwards - last->outwards);
      last = &m;
    }
  }

  static std::optional<Span> LookAt(std::vector<Met>* strip) {
    const auto far_in = [](const Met& m) { return m.outwards < -kReachM; };
    strip->erase(std::remove_if(strip->begin(), strip->end(), far_in), strip->end());
    const bool hidden = std::any_of(strip->begin(), strip->end(),
                                    [](const Met& m) { return m.label == Label::kBefore; });
    return hidden ? std::nullopt : Split(*strip);
  }

  void Add(Span span, const Recurrence& recurrence, const Eigen::Vector2d& outward, double half,
           double width, std::vector<FlatCrossing>* crossings) const {
    // What comes so much later that it is not the next beam beyond.
    constexpr double kMostGaps = 8;
    if (span.beyond && span.high - span.low > kMostGaps * recurrence.mean) span.beyond.reset();
    const Eigen::Vector3d point = cloud_.points[span.at].cast<double>();
    const auto met = Meet(point, plane_, frame_);
    if (!met) return;
    FlatCrossing crossing;
    double middle = 0.5 * (span.low + span.high);
    crossing.half_m = 0.5 * (span.high - span.low);
    if (!span.beyond) {
      middle = span.low + recurrence.mean;
      crossing.half_m = std::sqrt(3 * recurrence.variance);
    }
    const double at = outward.dot(met->flat - near_.centre) - half;
    crossing.middle = met->flat + (middle - at) * outward;
    crossing.outward = outward;
    crossing.length_m = width;
    crossing.range_m = met->range;
    const double towards = plane_.normal.dot(met->direction);
    crossing.slope =
        Eigen::Vector2d(frame_.u.dot(met->direction), frame_.v.dot(met->direction)) / -towards;
    crossing.kind = !span.beyond                  ? CrossingKind::kNoReturn
                    : *span.beyond == Label::kFar ? CrossingKind::kFar
                                                  : CrossingKind::kMerged;
    crossing.cell = crossings->size();
    crossing.gap = crossings->size();
    crossings->push_back(crossing);
  }

  const Cloud& cloud_;
  const Plane& plane_;
  const PlaneFrame& frame_;
  const FlatRectangle& near_;
  const Target& target_;
  std::vector<Flat> points_;
  double spacing_ = 0;
};

}  // namespace

FlatRectangle Centred(FlatRectangle near, const std::vector<FlatCrossing>& crossings,
                      const Target& target) {
  Eigen::Vector2d move = Eigen::Vector2d::Zero();
  for (const int side : {1, 2}) {  // and the one opposite
    const Eigen::Vector2d outward = OutwardOf(near, side);
    const double half = (side == 1 ? target.width_m : target.height_m) / 2;
    std::vector<double> here, opposite;
    for (const FlatCrossing& c : crossings) {
      const double place = outward.dot(c.middle - near.centre);
      if (outward.dot(c.outward) > 0.9) here.push_back(place - half);
      if (outward.dot(c.outward) < -0.9) opposite.push_back(place + half);
    }
    if (here.empty() || opposite.empty()) continue;
    move += 0.5 * (Median(std::move(here)) + Median(std::move(opposite))) * outward;
  }
  near.centre += move;
  return near;
}

std::vector<FlatCrossing> ScatteredCrossings(const Cloud& cloud, const Plane& plane,
                                             const PlaneFrame& frame, const FlatRectangle& near,
                                             const Target& target, double sigma_m) {
  const SideCutter cutter(cloud, plane, frame, near, target, sigma_m);
  std::vector<FlatCrossing> crossings;
  for (int side = 0; side < 4; ++side) cutter.Cut(side, &crossings);
  return crossings;
}

}  // namespace rgbdt
