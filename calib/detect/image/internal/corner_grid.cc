#include "calib/detect/image/internal/corner_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rgbdt {
namespace {

constexpr double kBin = 16;          // [px]
constexpr double kFarthest = 70;     // from a saddle to the next [px]; larger: at reduced size
constexpr double kAlike = 0.6;       // likeness of neighbours, signs apart
constexpr double kAngle = 0.3;       // a neighbour lies along an edge [rad]
constexpr double kTolerance = 0.22;  // of where the next saddle is predicted, of the distance to it
constexpr double kStrength = 2.5;    // a neighbour's strength differs by no more than this factor
constexpr double kRange = 5;         // nor a member's from the first one's by more than this one

constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

bool AsStrong(const Saddle& a, const Saddle& b, double factor) {
  return a.strength < factor * b.strength && b.strength < factor * a.strength;
}

// Where the saddle at (column, row) + step should lie, from what is known round it.
struct Prediction {
  Eigen::Vector2d sum{0, 0};
  double step = 0;  // length
  int count = 0;

  void Add(const Eigen::Vector2d& from, const Eigen::Vector2d& by) {
    sum += from + by;
    step += by.norm();
    ++count;
  }
};

}  // namespace

GridFinder::GridFinder(const std::vector<Saddle>& saddles, int largest)
    : saddles_(saddles), largest_(largest), used_(saddles.size(), 0) {
  for (const Saddle& saddle : saddles_) {
    columns_ = std::max(columns_, static_cast<int>(saddle.place.x() / kBin) + 1);
    rows_ = std::max(rows_, static_cast<int>(saddle.place.y() / kBin) + 1);
  }
  bins_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::size_t i = 0; i < saddles_.size(); ++i) {
    const Eigen::Vector2i bin = (saddles_[i].place / kBin).cast<int>();
    bins_[static_cast<std::size_t>(bin.y() * columns_ + bin.x())].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < saddles_.size(); ++i) {
    if (const auto seed = SeedAt(static_cast<int>(i))) seeds_.push_back(*seed);
  }
  std::stable_sort(seeds_.begin(), seeds_.end(),
                   [](const Seed& a, const Seed& b) { return a.irregularity < b.irregularity; });
}

template <typename Visit>
void GridFinder::ForEachNear(const Eigen::Vector2d& place, double radius,
                             const Visit& visit) const {
  const auto bin = [](double x, int count) {
    return std::clamp(static_cast<int>(std::floor(x / kBin)), 0, count - 1);
  };
  const int left = bin(place.x() - radius, columns_);
  const int right = bin(place.x() + radius, columns_);
  const int bottom = bin(place.y() + radius, rows_);
  for (int y = bin(place.y() - radius, rows_); y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      for (const int i : bins_[static_cast<std::size_t>(y * columns_ + x)]) {
        if ((saddles_[static_cast<std::size_t>(i)].place - place).squaredNorm() < radius * radius) {
          visit(i);
        }
      }
    }
  }
}

// The nearest saddle in a direction that could be the next of a grid; -1: none.
int GridFinder::NeighbourAlong(int from, double angle) const {
  const Saddle& saddle = saddles_[static_cast<std::size_t>(from)];
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  const double cosine = std::cos(kAngle);
  // Most neighbours are near: look there first.
  for (const double radius : {kFarthest / 3, kFarthest}) {
    int best = -1;
    double nearest = radius;
    // All of the sector lies within that circle.
    const Eigen::Vector2d middle = saddle.place + 0.5 * radius * direction;
    ForEachNear(middle, 0.55 * radius, [&](int i) {
      if (i == from) return;
      const Saddle& other = saddles_[static_cast<std::size_t>(i)];
      const Eigen::Vector2d offset = other.place - saddle.place;
      const double distance = offset.norm();
      if (distance >= nearest || offset.dot(direction) < cosine * distance) return;
      if (Likeness(saddle, other) > -kAlike || !AsStrong(saddle, other, kStrength)) return;
      nearest = distance;
      best = i;
    });
    if (best >= 0) return best;
  }
  return -1;
}

std::optional<GridFinder::Seed> GridFinder::SeedAt(int index) const {
  const Saddle& saddle = saddles_[static_cast<std::size_t>(index)];
  Seed seed;
  seed.saddle = index;
  for (const std::size_t k : {0U, 1U}) {
    const double angle = saddle.edges[k];
    const int ahead = NeighbourAlong(index, angle);
    if (ahead < 0) return std::nullopt;
    const int behind = NeighbourAlong(index, angle + 3.14159265358979323846);
    if (behind < 0) return std::nullopt;
    const Eigen::Vector2d a = saddles_[static_cast<std::size_t>(ahead)].place - saddle.place;
    const Eigen::Vector2d b = saddle.place - saddles_[static_cast<std::size_t>(behind)].place;
    (k == 0 ? seed.right : seed.down) = 0.5 * (a + b);
    seed.irregularity = std::max(seed.irregularity, (a - b).norm() / (a + b).norm());
  }
  if (seed.irregularity > 0.3) return std::nullopt;
  return seed;
}

int GridFinder::SaddleAt(const Eigen::Vector2d& place, double radius, const Saddle& like,
                         double sign, const std::vector<char>& taken) const {
  int best = -1;
  double nearest = radius;
  ForEachNear(place, radius, [&](int i) {
    const Saddle& other = saddles_[static_cast<std::size_t>(i)];
    const double distance = (other.place - place).norm();
    if (distance >= nearest || taken[static_cast<std::size_t>(i)] != 0) return;
    if (sign * Likeness(like, other) < kAlike || !AsStrong(like, other, kStrength)) return;
    nearest = distance;
    best = i;
  });
  return best;
}

GridFinder::Members GridFinder::Grow(const Seed& seed) const {
  Members members{{{0, 0}, seed.saddle}};
  std::vector<char> taken = used_;
  taken[static_cast<std::size_t>(seed.saddle)] = 1;
  const auto place = [&](int column, int row) -> const Eigen::Vector2d* {
    const auto at = members.find({column, row});
    return at == members.end() ? nullptr : &saddles_[static_cast<std::size_t>(at->second)].place;
  };
  // The step from (c, r) along (dc, dr) as seen there or in the row beside it.
  const auto predict = [&](int c, int r, int dc, int dr, Prediction* prediction) {
    const Eigen::Vector2d* from = place(c, r);
    if (const auto* before = place(c - dc, r - dr)) prediction->Add(*from, *from - *before);
    for (const int side : {-1, 1}) {
      const auto* a = place(c + side * dr, r + side * dc);
      const auto* b = place(c + side * dr + dc, r + side * dc + dr);
      if (a != nullptr && b != nullptr) prediction->Add(*from, *b - *a);
    }
    if (prediction->count == 0 && c == 0 && r == 0) {
      prediction->Add(*from, dc * seed.right + dr * seed.down);
    }
  };
  std::vector<std::pair<int, int>> front{{0, 0}};
  int low_column = 0, high_column = 0, low_row = 0, high_row = 0;
  for (std::size_t i = 0; i < front.size(); ++i) {  // breadth first
    const auto [column, row] = front[i];
    for (const auto& [dc, dr] : kSteps) {
      const int c = column + dc;
      const int r = row + dr;
      if (members.count({c, r}) != 0) continue;
      if (std::max(high_column, c) - std::min(low_column, c) >= largest_) continue;
      if (std::max(high_row, r) - std::min(low_row, r) >= largest_) continue;
      Prediction prediction;
      for (const auto& [ec, er] : kSteps) {  // each known neighbour has its say
        if (members.count({c - ec, r - er}) != 0) predict(c - ec, r - er, ec, er, &prediction);
      }
      if (prediction.count == 0) continue;
      const int n = prediction.count;
      const Saddle& like = saddles_[static_cast<std::size_t>(members.at({column, row}))];
      const int found =
          SaddleAt(prediction.sum / n, kTolerance * prediction.step / n, like, -1, taken);
      if (found < 0) continue;
      const Saddle& first = saddles_[static_cast<std::size_t>(seed.saddle)];
      if (!AsStrong(first, saddles_[static_cast<std::size_t>(found)], kRange)) continue;
      members[{c, r}] = found;
      taken[static_cast<std::size_t>(found)] = 1;
      low_column = std::min(low_column, c);
      high_column = std::max(high_column, c);
      low_row = std::min(low_row, r);
      high_row = std::max(high_row, r);
      front.emplace_back(c, r);
      // What could not be predicted before may be now.
      for (const auto& [ec, er] : kSteps) {
        if (members.count({c + ec, r + er}) != 0) front.emplace_back(c + ec, r + er);
      }
    }
  }
  return members;
}

std::optional<CornerGrid> GridFinder::Next(std::size_t least) {
  while (next_seed_ < seeds_.size()) {
    const Seed& seed = seeds_[next_seed_++];
    if (used_[static_cast<std::size_t>(seed.saddle)] != 0) continue;
    const Members members = Grow(seed);
    used_[static_cast<std::size_t>(seed.saddle)] = 1;
    if (members.size() < least) continue;
    CornerGrid grid;
    for (const auto& [at, saddle] : members) {
      used_[static_cast<std::size_t>(saddle)] = 1;
      grid[at] = saddles_[static_cast<std::size_t>(saddle)].place;
    }
    return grid;
  }
  return std::nullopt;
}

}  // namespace rgbdt
