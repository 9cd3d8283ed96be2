#include <limits>

#include "services/bus/check.h"
#include "services/bus/codec_types.h"

namespace rgbdt {
namespace {

// lcm-gen makes a vector of vectors of an array [n][2] or [n][3].
template <typename Row>
std::vector<std::vector<double>> RowsToWire(const std::vector<Row>& rows) {
  std::vector<std::vector<double>> wire(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    wire[i].assign(rows[i].data(), rows[i].data() + rows[i].size());
  }
  return wire;
}

template <typename Row>
std::vector<Row> RowsFromWire(const std::vector<std::vector<double>>& wire) {
  std::vector<Row> rows(wire.size());
  for (std::size_t i = 0; i < wire.size(); ++i) rows[i] = Row(wire[i].data());
  return rows;
}

void CheckRows(std::string_view field, const std::vector<std::vector<double>>& rows) {
  for (const std::vector<double>& row : rows) CheckFinite(field, row.data(), row.size());
}

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

void Copy(const Eigen::Vector3d& from, double to[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
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

void CloudToWire(const CloudEdges& cloud, observation_t* wire) {
  wire->has_cloud = 1;
  wire->num_boundary = CountOf(cloud.boundary.size(), "num_boundary");
  wire->boundary_m = RowsToWire(cloud.boundary);
  Copy(cloud.centre, wire->centre_m);
  Copy(cloud.normal, wire->normal);
  wire->width_m = cloud.width_m;
  wire->height_m = cloud.height_m;
  wire->spacing_m = cloud.spacing_m;
  wire->num_board_points = cloud.points;
}

void CheckImage(const observation_t& wire) {
  CheckRange("image_width", wire.image_width, 1, kMaxImageSide);
  CheckRange("image_height", wire.image_height, 1, kMaxImageSide);
  CheckFinite("outline_corner_px", wire.outline_corner_px[0], 8);
  CheckRows("corner_px", wire.corner_px);
  CheckRows("outline_px", wire.outline_px);
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    CheckRange("edge_pixel x", pixel[0], 0, wire.image_width - 1);
    CheckRange("edge_pixel y", pixel[1], 0, wire.image_height - 1);
  }
}

void CheckCloud(const observation_t& wire) {
  CheckRows("boundary_m", wire.boundary_m);
  CheckFinite("centre_m", wire.centre_m, 3);
  CheckUnitVector("normal", Eigen::Vector3d(wire.normal));
  CheckNotNegative("width_m", wire.width_m);
  CheckNotNegative("height_m", wire.height_m);
  CheckNotNegative("spacing_m", wire.spacing_m);
  CheckRange("num_board_points", wire.num_board_points, 0,
             std::numeric_limits<std::int32_t>::max());
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

CloudEdges CloudFromWire(const observation_t& wire) {
  CloudEdges cloud;
  cloud.boundary = RowsFromWire<Eigen::Vector3d>(wire.boundary_m);
  cloud.centre = Eigen::Vector3d(wire.centre_m);
  cloud.normal = Eigen::Vector3d(wire.normal);
  cloud.width_m = wire.width_m;
  cloud.height_m = wire.height_m;
  cloud.spacing_m = wire.spacing_m;
  cloud.points = wire.num_board_points;
  return cloud;
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

observation_t ToWire(const Observation& observation) {
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
  if (observation.cloud) CloudToWire(*observation.cloud, &wire);
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
  if (wire.has_cloud != 0) CheckCloud(wire);
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
  if (wire.has_cloud != 0) observation.cloud = CloudFromWire(wire);
  return observation;
}

}  // namespace rgbdt
