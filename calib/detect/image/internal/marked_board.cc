#include "calib/detect/image/internal/marked_board.h"

#include <algorithm>
#include <cmath>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/detect/image/internal/marker_decode.h"
#include "calib/detect/image/internal/marker_layout.h"
#include "calib/detect/image/internal/measured_corners.h"
#include "calib/detect/image/internal/why_no_markers.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

constexpr double kGridTolerance = 0.2;  // of the distance to the next corner
constexpr double kMostLost = 0.05;      // of the corners, that may be taken from the others' grid

// Which inner corners a marker is beside.
std::vector<bool> BesideMarkers(const Target& target, const std::vector<MarkerPlace>& places) {
  const double side = target.markers->grid() ? target.markers->side_m : target.square_m;
  const auto corners = target.InnerCorners();
  std::vector<bool> beside(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    beside[i] = std::any_of(places.begin(), places.end(), [&](const MarkerPlace& place) {
      return (corners[i].head<2>() - place.centre).cwiseAbs().maxCoeff() < 0.6 * side;
    });
  }
  return beside;
}

std::optional<GridModel> ModelOf(const Target& target, const MeasuredCorners& measured) {
  std::vector<GridModel::Point> points;
  const auto corners = target.InnerCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!measured.fits[i]) continue;
    points.push_back({corners[i].head<2>() / target.square_m, measured.fits[i]->place});
  }
  return GridModel::Fit(points, kGridTolerance);
}

// Takes out what lies off the map by more than noise does, and a little for what it cannot follow.
void DropOffMap(const BoardMap& map, const Target& target, MeasuredCorners* measured) {
  const auto corners = target.InnerCorners();
  const double sigma = measured->sigma_px();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    auto& fit = measured->fits[i];
    if (!fit) continue;
    const double spacing = measured->spacings[i];
    const double tolerance = std::min(0.15 + 4.5 * sigma + 0.005 * spacing, 0.15 * spacing);
    const auto place = map(corners[i].head<2>());
    if (!place || (*place - fit->place).norm() > tolerance) fit.reset();
  }
}

// Of a board that is seen but for a few corners these follow from the others, as FindCheckerboard
// has it.
void FillIn(const BoardMap& map, const Target& target, std::vector<Eigen::Vector2d>* corners) {
  const auto points = target.InnerCorners();
  const auto seen = std::count_if(corners->begin(), corners->end(), IsSeen);
  if (static_cast<double>(seen) < (1 - kMostLost) * static_cast<double>(points.size())) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!IsSeen((*corners)[i])) (*corners)[i] = *map(points[i].head<2>());
  }
}

std::string WhyTooFew(const MarkerLayout& layout, const MeasuredCorners& measured) {
  return "beside the " + std::to_string(layout.agreed.size()) + " markers that are seen only " +
         std::to_string(measured.count()) + " inner corners can be measured; at least " +
         std::to_string(kLeastCorners) +
         ", in three rows and columns, are needed: show more of the board, nearer and sharp";
}

}  // namespace

CheckerboardResult FindMarkedBoard(const cv::Mat& grey, const Target& target, double saturated_from,
                                   bool tell_why) {
  CheckerboardResult result;
  const cv::Mat repaired = RepairDeadPixels(grey);
  const Markers& markers = *target.markers;
  const auto seen = DecodeMarkers(repaired, *FindMarkerFamily(markers.family), markers.border_bits,
                                  target.MarkerPlaces().size() * 9 / 10);
  result.why = WhyNotThisBoard(target, seen);
  if (!result.why.empty()) return result;
  const auto layout = LayOut(seen, target);
  if (!layout) {
    result.why = tell_why ? WhyNoMarkers(repaired, target, seen) : "its markers are not seen";
    return result;
  }
  const auto otherwise = LayOutOtherWay(target, seen);
  if (otherwise && otherwise->agreed.size() > layout->agreed.size()) {
    result.why = WhyOtherWay(target);
    return result;
  }
  const auto wanted = BesideMarkers(target, layout->agreed);
  MeasuredCorners measured = MeasureCorners(
      repaired, saturated_from, target, MapByModel(layout->model, target), std::nullopt, wanted);
  DropUnlike(&measured);
  // Again with the blur that all corners agree on, and edges along the grid's lines.
  auto model = ModelOf(target, measured);
  if (model) {
    measured = MeasureCorners(repaired, saturated_from, target, MapByModel(*model, target),
                              measured.blur_px(), wanted);
    DropUnlike(&measured);
    model = ModelOf(target, measured);
  }
  if (model) DropOffMap(MapByModel(*model, target), target, &measured);
  if (!model || !Enough(target, measured)) {
    result.why = WhyTooFew(*layout, measured);
    return result;
  }
  Checkerboard board;
  board.corners = measured.places();
  FillIn(MapByModel(*model, target), target, &board.corners);
  board.top_left_dark = measured.contrast() < 0;
  board.order_known = true;
  board.sigma_px = measured.sigma_px();
  result.board = std::move(board);
  return result;
}

}  // namespace rgbdt
