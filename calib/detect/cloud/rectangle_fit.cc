#include "calib/detect/cloud/rectangle_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kBin = 0.01;  // of the votes [m]

// Axes of a rectangle at an angle.
struct Axes {
  Eigen::Vector2d x, y;
  explicit Axes(double angle)
      : x(std::cos(angle), std::sin(angle)), y(-std::sin(angle), std::cos(angle)) {}
};

// Outward normals of sides 0 to 3 and their distance from the centre.
Eigen::Vector2d NormalOf(const Axes& axes, int side) {
  switch (side) {
    case 0:
      return -axes.y;
    case 1:
      return axes.x;
    case 2:
      return axes.y;
    default:
      return -axes.x;
  }
}

// A line of votes: metres of side that lie at each place.
class Votes {
 public:
  Votes(double low, double high)
      : low_(low), bins_(static_cast<std::size_t>((high - low) / kBin) + 8, 0.0) {}

  // A vote spread over what the crossing leaves open, at least a centimetre either way.
  void Add(double place, double half, double weight) {
    const double reach = std::max(0.012, half);
    const int first = static_cast<int>(std::floor((place - reach - low_) / kBin));
    const int last = static_cast<int>(std::floor((place + reach - low_) / kBin));
    // Each bin that the truth may lie in gets the whole vote: the best place explains most of them.
    for (int b = std::max(0, first); b <= std::min(last, static_cast<int>(bins_.size()) - 1); ++b) {
      bins_[static_cast<std::size_t>(b)] += weight;
    }
  }
  double At(std::size_t bin) const { return bin < bins_.size() ? bins_[bin] : 0; }
  std::size_t size() const { return bins_.size(); }
  double Place(std::size_t bin) const { return low_ + (static_cast<double>(bin) + 0.5) * kBin; }

 private:
  double low_;
  std::vector<double> bins_;
};

struct Peak {
  double place = 0;  // of the centre along the axis
  double metres = 0;
};

// Votes for places of the centre along an axis, from crossings that face along it and against it.
std::vector<double> MetresAlong(const std::vector<FlatCrossing>& crossings,
                                const Eigen::Vector2d& axis, double extent, double other,
                                double* first_place) {
  constexpr double kFacing = 0.25;
  double low = 1e9;
  double high = -1e9;
  for (const FlatCrossing& c : crossings) {
    const double place = c.middle.dot(axis);
    low = std::min(low, place);
    high = std::max(high, place);
  }
  Votes with(low - extent / 2, high + extent / 2);
  Votes against(low - extent / 2, high + extent / 2);
  for (const FlatCrossing& c : crossings) {
    const double facing = c.outward.dot(axis);
    if (std::abs(facing) < kFacing) continue;
    const double place = c.middle.dot(axis) - std::copysign(extent / 2, facing);
    // A scan that crosses a side at a slant stands for less of it.
    const double weight = c.length_m * std::abs(facing);
    (facing > 0 ? with : against).Add(place, c.half_m * std::abs(facing), weight);
  }
  std::vector<double> metres;
  for (std::size_t b = 0; b < with.size(); ++b) {
    // Neither side can be explained more than wholly: rows and columns may both cross it.
    metres.push_back(std::min(with.At(b), other) + std::min(against.At(b), other));
  }
  *first_place = with.Place(0);
  return metres;
}

// The best places, best first: one where both sides are seen; two where each explains one side
// (something flush with the board occludes the other).
std::vector<Peak> BestAlong(const std::vector<FlatCrossing>& crossings, const Eigen::Vector2d& axis,
                            double extent, double other) {
  constexpr double kApart = 0.05;
  double first_place = 0;
  std::vector<double> metres = MetresAlong(crossings, axis, extent, other, &first_place);
  std::vector<Peak> peaks;
  while (peaks.size() < 2) {
    const auto most = std::max_element(metres.begin(), metres.end());
    if (most == metres.end()) break;
    const double height = *most;
    auto last = most;
    while (last + 1 != metres.end() && *(last + 1) == height) ++last;
    const auto place = [&](auto bin) {
      return first_place + kBin * static_cast<double>(bin - metres.begin());
    };
    const Peak peak{0.5 * (place(most) + place(last)), height};
    if (!peaks.empty() && peak.metres < 0.6 * peaks[0].metres) break;
    peaks.push_back(peak);
    if (peak.metres > 1.5 * other) break;  // both sides, mostly
    for (auto bin = metres.begin(); bin != metres.end(); ++bin) {
      if (std::abs(place(bin) - peak.place) < kApart) *bin = 0;
    }
  }
  return peaks;
}

}  // namespace

std::vector<FlatRectangle> VoteForRectangles(const std::vector<FlatCrossing>& crossings,
                                             double width_m, double height_m) {
  if (crossings.size() < 8) return {};
  constexpr int kAngles = 90;
  double most = 0;
  double angle = 0;
  for (int i = 0; i < kAngles; ++i) {
    const Axes axes(i * M_PI / kAngles);
    const auto x = BestAlong(crossings, axes.x, width_m, height_m);
    const auto y = BestAlong(crossings, axes.y, height_m, width_m);
    if (x[0].metres + y[0].metres <= most) continue;
    most = x[0].metres + y[0].metres;
    angle = i * M_PI / kAngles;
  }
  const Axes axes(angle);
  std::vector<FlatRectangle> rectangles;
  for (const Peak& x : BestAlong(crossings, axes.x, width_m, height_m)) {
    for (const Peak& y : BestAlong(crossings, axes.y, height_m, width_m)) {
      FlatRectangle rectangle;
      rectangle.centre = x.place * axes.x + y.place * axes.y;
      rectangle.angle_rad = angle;
      rectangle.coverage = (x.metres + y.metres) / (2 * (width_m + height_m));
      if (rectangle.coverage >= 0.5) rectangles.push_back(std::move(rectangle));
    }
  }
  return rectangles;
}

namespace {

constexpr int kParameters = 11;  // centre, angle, 3 classes, 4 sides, thickness
constexpr int kClass = 2, kSide = 6, kThickness = 10;  // a class's number begins at 1
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters, kParameters>;

class Refiner {
 public:
  Refiner(const std::vector<FlatCrossing>& crossings, double width, double height,
          const BeamEdgeOptions& options)
      : crossings_(crossings), width_(width), height_(height), options_(options) {}

  FlatRectangle Run(const FlatRectangle& start) {
    Parameters x = Parameters::Zero();
    x.head<2>() = start.centre;
    x[2] = start.angle_rad;
    Normal information = Normal::Identity();
    double chi2 = 0;
    int used = 0;
    for (int round = 0; round < 12; ++round) {
      // At first the angle is known to a degree only; then what lies off is left out.
      const double gate = round < 4 ? 0.05 : round < 8 ? 0.025 : 0.01;
      Assign(x, gate);
      const Parameters step = Step(x, &information, &chi2, &used);
      x += step;
      if (round >= 8 && step.norm() < 1e-9) break;
    }
    return Result(x, information, chi2, used);
  }

 private:
  double PriorSigma(int k) const {
    if (k == kThickness) return options_.thickness_sigma_m;
    return k < kSide ? options_.class_sigma_rad : options_.side_sigma_rad;
  }

  double HalfExtent(int side) const { return side % 2 == 1 ? width_ / 2 : height_ / 2; }

  // Metres that a side with this outward normal seems farther out, for each radian of shift: a
  // beam that meets the plane at a slant is drawn out on it.
  static double PerRadian(const FlatCrossing& c, const Eigen::Vector2d& normal) {
    const double sideways = c.slope.dot(normal) / std::sqrt(1 + c.slope.squaredNorm());
    return c.range_m / std::sqrt(1 - sideways * sideways);
  }

  // The same for each metre of thickness: a rim that faces the LIDAR is seen beside the front.
  static double PerThickness(const FlatCrossing& c, const Eigen::Vector2d& normal) {
    return std::max(0.0, -c.slope.dot(normal));
  }

  // Distance of a crossing outwards of a side.
  double Beyond(const Parameters& x, const FlatCrossing& c, int side) const {
    const Eigen::Vector2d normal = NormalOf(Axes(x[2]), side);
    const double shift =
        PerRadian(c, normal) * (x[kClass + static_cast<int>(c.kind)] + x[kSide + side]) +
        PerThickness(c, normal) * x[kThickness];
    return normal.dot(c.middle - x.head<2>()) - HalfExtent(side) - shift;
  }

  // Of one of `same` crossings in one gap: the truth is evenly spread over the interval, but at the
  // same place of it for all of them, so together they are worth one; and a beam
  // does not end sharply, which averages out.
  double Variance(const FlatCrossing& c, const Eigen::Vector2d& normal, int same) const {
    const double half = c.half_m * normal.dot(c.outward);
    const double blur = options_.blur_rad * PerRadian(c, normal);
    return same * half * half / 3 + blur * blur;
  }

  // Each crossing's side: the nearest that it faces, within the interval and the gate.
  void Assign(const Parameters& x, double gate) {
    const Axes axes(x[2]);
    side_.assign(crossings_.size(), -1);
    std::map<std::pair<std::size_t, int>, int> cells;
    std::map<std::tuple<std::size_t, bool, int>, int> gaps;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const FlatCrossing& c = crossings_[i];
      double nearest = 1;
      for (int side = 0; side < 4; ++side) {
        const double facing = NormalOf(axes, side).dot(c.outward);
        if (facing < 0.25) continue;
        const Eigen::Vector2d d = c.middle - x.head<2>();
        const double along = std::abs((side % 2 == 1 ? axes.y : axes.x).dot(d));
        const double most = side % 2 == 1 ? height_ / 2 : width_ / 2;
        // Near a corner of the board a crossing may belong to either side.
        if (along > most - 0.5 * c.half_m) continue;
        const double off = std::abs(Beyond(x, c, side)) / (gate + c.half_m * facing);
        if (off < nearest) {
          nearest = off;
          side_[i] = side;
        }
      }
      if (side_[i] < 0) continue;
      ++cells[{c.cell, side_[i]}];
      ++gaps[{c.gap, c.along_row, side_[i]}];
    }
    shared_.assign(crossings_.size(), 1);
    same_.assign(crossings_.size(), 1);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      if (side_[i] < 0) continue;
      shared_[i] = cells[{crossings_[i].cell, side_[i]}];
      same_[i] = gaps[{crossings_[i].gap, crossings_[i].along_row, side_[i]}];
    }
  }

  Parameters Step(const Parameters& x, Normal* information, double* chi2, int* used) const {
    Normal h = Normal::Zero();
    Parameters g = Parameters::Zero();
    *chi2 = 0;
    *used = 0;
    const Axes axes(x[2]);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const int side = side_[i];
      if (side < 0) continue;
      const FlatCrossing& c = crossings_[i];
      const double residual = Beyond(x, c, side);
      const Eigen::Vector2d normal = NormalOf(axes, side);
      const double variance = Variance(c, normal, same_[i]) * shared_[i];
      Parameters j = Parameters::Zero();
      j.head<2>() = -normal;
      const Eigen::Vector2d turned(-normal.y(), normal.x());
      j[2] = turned.dot(c.middle - x.head<2>());
      j[kClass + static_cast<int>(c.kind)] = -PerRadian(c, normal);
      j[kSide + side] = -PerRadian(c, normal);
      j[kThickness] = -PerThickness(c, normal);
      const double whitened2 = residual * residual / Variance(c, normal, 1);
      const double robust = 1 / (1 + whitened2 / 9);  // Cauchy
      const double weight = robust / variance;
      h += weight * j * j.transpose();
      g -= weight * residual * j;
      *chi2 += robust * whitened2;
      ++*used;
    }
    for (int k = 3; k < kParameters; ++k) {
      const double sigma = PriorSigma(k);
      h(k, k) += 1 / (sigma * sigma);
      g[k] -= (x[k] - (k == kThickness ? options_.thickness_m : 0)) / (sigma * sigma);
    }
    *information = h;
    return SolveSymmetric(h, g);
  }

  FlatRectangle Result(const Parameters& x, const Normal& information, double chi2,
                       int used) const {
    FlatRectangle out;
    out.centre = x.head<2>();
    out.angle_rad = x[2];
    const Normal covariance = InverseOfSymmetric(information);
    const double scale = used > 10 ? std::max(1.0, chi2 / used) : 1.0;
    out.misfit = chi2 / std::max(1, used);
    out.covariance = scale * covariance.topLeftCorner<3, 3>();
    for (int k = 0; k < 3; ++k) {
      out.shift_rad[static_cast<std::size_t>(k)] = x[3 + k];
      out.shift_sigma_rad[static_cast<std::size_t>(k)] = std::sqrt(covariance(3 + k, 3 + k));
    }
    for (int k = 3; k < kParameters; ++k) {
      const double off = x[k] - (k == kThickness ? options_.thickness_m : 0);
      out.prior_deviation = std::hypot(out.prior_deviation, off / PriorSigma(k));
    }
    out.thickness_m = x[kThickness];
    out.thickness_sigma_m = std::sqrt(covariance(kThickness, kThickness));
    out.side = side_;
    const Axes axes(x[2]);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const FlatCrossing& c = crossings_[i];
      const Eigen::Vector2d normal = NormalOf(axes, std::max(0, side_[i]));
      const bool on_side = side_[i] >= 0;
      out.half_width_m.push_back(on_side ? c.half_m * normal.dot(c.outward) : 0);
      out.sigma_m.push_back(on_side ? std::sqrt(shared_[i] * Variance(c, normal, same_[i])) : 0);
    }
    Cover(x, &out);
    return out;
  }

  // Which part of each side has a crossing on it, in pieces of a twentieth.
  void Cover(const Parameters& x, FlatRectangle* out) const {
    constexpr int kPieces = 20;
    std::array<std::array<bool, kPieces>, 4> covered{};
    const Axes axes(x[2]);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const int side = side_[i];
      if (side < 0) continue;
      const FlatCrossing& c = crossings_[i];
      const double extent = side % 2 == 1 ? height_ : width_;
      const double along = (side % 2 == 1 ? axes.y : axes.x).dot(c.middle - x.head<2>());
      const double facing = std::abs(NormalOf(axes, side).dot(c.outward));
      const double half = std::max(0.01, 0.6 * c.length_m / std::max(0.3, facing));
      const auto piece = [&](double a) {
        return std::clamp(static_cast<int>((a / extent + 0.5) * kPieces), 0, kPieces - 1);
      };
      for (int k = piece(along - half); k <= piece(along + half); ++k) {
        covered[static_cast<std::size_t>(side)][static_cast<std::size_t>(k)] = true;
      }
    }
    double total = 0;
    for (int side = 0; side < 4; ++side) {
      const auto s = static_cast<std::size_t>(side);
      out->side_coverage[s] =
          static_cast<double>(std::count(covered[s].begin(), covered[s].end(), true)) / kPieces;
      total += out->side_coverage[s] * (side % 2 == 1 ? height_ : width_);
    }
    out->coverage = total / (2 * (width_ + height_));
  }

  const std::vector<FlatCrossing>& crossings_;
  double width_, height_;
  const BeamEdgeOptions& options_;
  std::vector<int> side_;
  std::vector<int> shared_;  // by crossing: how many of its cell lie on the same side
  std::vector<int> same_;    // by crossing: how many of its gap lie on the same side
};

}  // namespace

FlatRectangle RefineRectangle(const std::vector<FlatCrossing>& crossings, double width_m,
                              double height_m, const FlatRectangle& start,
                              const BeamEdgeOptions& options) {
  return Refiner(crossings, width_m, height_m, options).Run(start);
}

}  // namespace rgbdt
