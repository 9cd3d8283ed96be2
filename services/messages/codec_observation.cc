#include <cmath>

#include "services/messages/check.h"
#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

void CornersToWire(const std::array<Eigen::Vector2d, 4>& corners, double wire[4][2]) {
  for (std::size_t i = 0; i < 4; ++i) {
    wire[i][0] = corners[i].x();
    wire[i][1] = corners[i].y();
  }
}

std::array<Eigen::Vector2d, 4> CornersFromWire(const double wire[4][2]) {
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = Eigen::Vector2d(wire[i]);
  return corners;
}

void ImageToWire(const ImageEdges& image, observation_t* wire) {
  wire->has_image = 1;
  wire->image_width = image.width;
  wire->image_height = image.height;
  wire->picked = static_cast<std::int8_t>(image.picked);
  CornersToWire(image.outline_corners, wire->outline_corner_px);
  wire->num_corners = CountOf(image.corners.size(), "num_corners");
  wire->corner_px = RowsToWire(image.corners);
  wire->num_outline = CountOf(image.outline.size(), "num_outline");
  wire->outline_px = RowsToWire(image.outline);
  wire->num_edge_pixels = CountOf(image.edge_pixels.size(), "num_edge_pixels");
  wire->edge_pixel.reserve(image.edge_pixels.size());
  for (const Eigen::Vector2i& pixel : image.edge_pixels) {
    CheckRange("edge_pixel x", pixel.x(), 0, image.width - 1);
    CheckRange("edge_pixel y", pixel.y(), 0, image.height - 1);
    wire->edge_pixel.push_back(
        {static_cast<std::int16_t>(pixel.x()), static_cast<std::int16_t>(pixel.y())});
  }
}

// A corner that was not seen is NaN, in both coordinates.
void CheckCorners(const std::vector<std::vector<double>>& corners) {
  for (const std::vector<double>& corner : corners) {
    const bool unseen = std::isnan(corner[0]) && std::isnan(corner[1]);
    if (!unseen) CheckFinite("corner_px", corner.data(), corner.size());
  }
}

void CheckImage(const observation_t& wire) {
  CheckRange("image_width", wire.image_width, 1, kMaxImageSide);
  CheckRange("image_height", wire.image_height, 1, kMaxImageSide);
  CheckFinite("outline_corner_px", wire.outline_corner_px[0], 8);
  CheckCorners(wire.corner_px);
  CheckRows("outline_px", wire.outline_px);
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    CheckRange("edge_pixel x", pixel[0], 0, wire.image_width - 1);
    CheckRange("edge_pixel y", pixel[1], 0, wire.image_height - 1);
  }
}

ImageEdges ImageFromWire(const observation_t& wire) {
  ImageEdges image;
  image.width = wire.image_width;
  image.height = wire.image_height;
  image.picked = wire.picked != 0;
  image.outline_corners = CornersFromWire(wire.outline_corner_px);
  image.corners = RowsFromWire<Eigen::Vector2d>(wire.corner_px);
  image.outline = RowsFromWire<Eigen::Vector2d>(wire.outline_px);
  image.edge_pixels.reserve(wire.edge_pixel.size());
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    image.edge_pixels.emplace_back(pixel[0], pixel[1]);
  }
  return image;
}

}  // namespace

corner_selection_t ToWire(const CornerSelection& selection) {
  corner_selection_t wire;
  wire.utime = selection.utime;
  wire.seq = selection.seq;
  wire.camera = selection.camera;
  wire.image_utime = selection.image_utime;
  CornersToWire(selection.corners, wire.corner_px);
  return wire;
}

void Check(const corner_selection_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckCameraName("camera", wire.camera);
  CheckUtime("image_utime", wire.image_utime);
  CheckFinite("corner_px", wire.corner_px[0], 8);
}

CornerSelection FromWire(const corner_selection_t& wire) {
  CornerSelection selection;
  selection.utime = wire.utime;
  selection.seq = wire.seq;
  selection.camera = wire.camera;
  selection.image_utime = wire.image_utime;
  selection.corners = CornersFromWire(wire.corner_px);
  return selection;
}

observation_t ToFirstVersion(const Observation& observation) {
  observation_t wire{};
  wire.utime = observation.image_utime;
  wire.seq = observation.seq;
  wire.view = observation.view;
  wire.camera = observation.camera;
  wire.sweep_utime = observation.sweep_utime;
  wire.heldout = static_cast<std::int8_t>(observation.heldout);
  wire.rejected = observation.rejected;
  wire.detect_image_s = observation.detect_image_s;
  wire.detect_cloud_s = observation.detect_cloud_s;
  if (observation.image) ImageToWire(*observation.image, &wire);
  wire.has_cloud = static_cast<std::int8_t>(observation.cloud.has_value());
  if (observation.cloud) BoardToWire(*observation.cloud, &wire);
  return wire;
}

void Check(const observation_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckName("view", wire.view);
  CheckCameraName("camera", wire.camera);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  CheckText("rejected", wire.rejected);
  CheckNotNegative("detect_image_s", wire.detect_image_s);
  CheckNotNegative("detect_cloud_s", wire.detect_cloud_s);
  if (wire.has_image != 0) CheckImage(wire);
  if (wire.has_cloud != 0) CheckBoard(wire);
  if (wire.rejected.empty() && (wire.has_image == 0 || wire.has_cloud == 0)) {
    Fail("rejected", std::string("empty"), "a reason, as image or cloud is missing");
  }
}

Observation FromWire(const observation_t& wire) {
  Observation observation;
  observation.view = wire.view;
  observation.camera = wire.camera;
  observation.seq = wire.seq;
  observation.sweep_utime = wire.sweep_utime;
  observation.image_utime = wire.utime;
  observation.heldout = wire.heldout != 0;
  observation.rejected = wire.rejected;
  observation.detect_image_s = wire.detect_image_s;
  observation.detect_cloud_s = wire.detect_cloud_s;
  if (wire.has_image != 0) observation.image = ImageFromWire(wire);
  if (wire.has_cloud != 0) observation.cloud = BoardFromWire(wire);
  return observation;
}

}  // namespace rgbdt
