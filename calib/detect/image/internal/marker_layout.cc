#include "calib/detect/image/internal/marker_layout.h"

#include <array>
#include <cstddef>
#include <map>
#include <opencv2/calib3d.hpp>
#include <utility>

namespace rgbdt {
namespace {

constexpr double kGross = 1;        // off the others' homography, in squares: a wrong marker
constexpr double kTolerance = 0.2;  // of a marker's corner, in squares
constexpr std::size_t kLeastMarkers = 2;

using Points = std::vector<GridModel::Point>;

struct OnBoard {
  std::vector<MarkerPlace> places;
  Points points;  ///< four a marker
};

OnBoard Pair(const std::vector<SeenMarker>& seen, const Target& target, std::size_t turn) {
  constexpr std::array<std::pair<double, double>, 4> kCorners{
      {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
  std::map<int, MarkerPlace> places;
  for (const MarkerPlace& place : target.MarkerPlaces()) places[place.id] = place;
  OnBoard on_board;
  for (const SeenMarker& marker : seen) {
    const auto place = places.find(marker.id);
    if (place == places.end()) continue;
    on_board.places.push_back(place->second);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& corner = kCorners[(i + turn) % 4];
      const Eigen::Vector2d at =
          place->second.centre +
          target.markers->side_m * Eigen::Vector2d(corner.first, corner.second);
      on_board.points.push_back({at / target.square_m, marker.corners[i]});
    }
  }
  return on_board;
}

// Keeps the markers of which `good` takes all four corners.
template <typename Good>
OnBoard Kept(const OnBoard& all, const Good& good) {
  OnBoard kept;
  for (std::size_t i = 0; i < all.places.size(); ++i) {
    bool all_four = true;
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) all_four &= good(k);
    if (!all_four) continue;
    kept.places.push_back(all.places[i]);
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) kept.points.push_back(all.points[k]);
  }
  return kept;
}

// Without what is nowhere near where the others say.
OnBoard WithoutGross(const OnBoard& all, const Target& target) {
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  double sides = 0;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    from.emplace_back(all.points[i].at.x(), all.points[i].at.y());
    to.emplace_back(all.points[i].place.x(), all.points[i].place.y());
    const std::size_t next = i % 4 == 3 ? i - 3 : i + 1;
    sides += (all.points[next].place - all.points[i].place).norm();
  }
  const double square_px =
      sides / static_cast<double>(all.points.size()) * target.square_m / target.markers->side_m;
  std::vector<unsigned char> inliers;
  if (cv::findHomography(from, to, cv::RANSAC, kGross * square_px, inliers).empty()) return {};
  return Kept(all, [&](std::size_t k) { return inliers[k] != 0; });
}

}  // namespace

BoardMap MapByModel(const GridModel& model, const Target& target) {
  return [model, square = target.square_m](const Eigen::Vector2d& p) {
    return std::optional<Eigen::Vector2d>(model.At(p.x() / square, p.y() / square));
  };
}

std::optional<MarkerLayout> LayOut(const std::vector<SeenMarker>& seen, const Target& target) {
  std::optional<MarkerLayout> best;
  const std::size_t turns = target.markers->grid() && !target.holes ? 4 : 1;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    const OnBoard all = Pair(seen, target, turn);
    if (all.places.size() < kLeastMarkers) continue;
    const OnBoard near = WithoutGross(all, target);
    if (near.places.size() < kLeastMarkers) continue;
    const auto model = GridModel::Fit(near.points, kTolerance);
    if (!model) continue;
    OnBoard agreed =
        Kept(near, [&](std::size_t k) { return model->Agrees(near.points[k], kTolerance); });
    if (agreed.places.size() < kLeastMarkers || 3 * agreed.places.size() < 2 * all.places.size()) {
      continue;
    }
    if (best && best->agreed.size() >= agreed.places.size()) continue;
    best = MarkerLayout{*model, std::move(agreed.places)};
  }
  return best;
}

}  // namespace rgbdt
