#include <cmath>

#include "services/messages/check.h"
#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {
namespace {

// A corner that was not seen is NaN, in both coordinates.
void CheckCorners(const std::vector<std::vector<double>>& corners) {
  for (const std::vector<double>& corner : corners) {
    const bool unseen = std::isnan(corner[0]) && std::isnan(corner[1]);
    if (!unseen) CheckFinite("corner_px", corner.data(), corner.size());
  }
}

void CheckEdges(const image_detection_t& wire) {
  CheckRange("image_width", wire.image_width, 1, kMaxImageSide);
  CheckRange("image_height", wire.image_height, 1, kMaxImageSide);
  CheckFinite("outline_corner_px", wire.outline_corner_px[0], 8);
  CheckCorners(wire.corner_px);
  CheckNotNegative("corner_sigma_px", wire.corner_sigma_px);
  CheckRows("outline_px", wire.outline_px);
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    CheckRange("edge_pixel x", pixel[0], 0, wire.image_width - 1);
    CheckRange("edge_pixel y", pixel[1], 0, wire.image_height - 1);
  }
  if (wire.has_pose != 0) CheckPart("pose", wire.pose);
  for (std::size_t i = 0; i < 4; ++i) CheckPart(At("side", i), wire.side[i]);
}

}  // namespace

// All but the edge pixels, ints that must fit into 16 bits.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, image_detection_t>& wire,
            StructOf<Copy, ImageEdges>& edges) {
  copy(wire.image_width, edges.width);
  copy(wire.image_height, edges.height);
  copy(wire.picked, edges.picked);
  copy(wire.outline_corner_px, edges.outline_corners);
  copy.List("num_corners", wire.num_corners, wire.corner_px, edges.corners);
  copy(wire.corner_sigma_px, edges.corner_sigma_px);
  copy.List("num_outline", wire.num_outline, wire.outline_px, edges.outline);
  copy.Optional(wire.has_pose, wire.pose, edges.pose);
  copy(wire.side, edges.sides);
}

// All but the edges.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, image_detection_t>& wire,
            StructOf<Copy, ImageDetection>& image) {
  copy(wire.camera, image.camera);
  copy(wire.utime, image.utime);
  copy(wire.why_not, image.why_not);
  copy(wire.detect_s, image.detect_s);
}

image_detection_t ToWire(const ImageDetection& image) {
  auto wire = FieldsToWire<image_detection_t>(image);
  if (!image.edges) return wire;
  const ImageEdges& edges = *image.edges;
  wire.has_edges = 1;
  Fields(CopyToWire(), wire, edges);
  wire.num_edge_pixels = CountOf(edges.edge_pixels.size(), "num_edge_pixels");
  wire.edge_pixel.reserve(edges.edge_pixels.size());
  for (const Eigen::Vector2i& pixel : edges.edge_pixels) {
    CheckRange("edge_pixel x", pixel.x(), 0, edges.width - 1);
    CheckRange("edge_pixel y", pixel.y(), 0, edges.height - 1);
    wire.edge_pixel.push_back(
        {static_cast<std::int16_t>(pixel.x()), static_cast<std::int16_t>(pixel.y())});
  }
  return wire;
}

void Check(const image_detection_t& wire) {
  CheckCameraName("camera", wire.camera);
  CheckUtimeOrZero("utime", wire.utime);
  CheckText("why_not", wire.why_not);
  CheckNotNegative("detect_s", wire.detect_s);
  if (wire.has_edges != 0) CheckEdges(wire);
  if (wire.why_not.empty() && wire.has_edges == 0) {
    Fail("why_not", std::string("empty"), "a reason, as the board was not found");
  }
}

ImageDetection FromWire(const image_detection_t& wire) {
  auto image = FieldsFromWire<ImageDetection>(wire);
  if (wire.has_edges == 0) return image;
  ImageEdges& edges = image.edges.emplace();
  Fields(CopyFromWire(), wire, edges);
  edges.edge_pixels.reserve(wire.edge_pixel.size());
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    edges.edge_pixels.emplace_back(pixel[0], pixel[1]);
  }
  return image;
}

// All but the time, which follows from its parts.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, view_detection_t>& wire,
            StructOf<Copy, ViewDetection>& detection) {
  copy(wire.seq, detection.seq);
  copy(wire.view, detection.view);
  copy(wire.sweep_utime, detection.sweep_utime);
  copy(wire.heldout, detection.heldout);
  copy.List("num_images", wire.num_images, wire.image, detection.images);
  copy.List("num_candidates", wire.num_candidates, wire.candidate, detection.cloud.candidates);
  copy(wire.cloud_why_not, detection.cloud.why_not);
  copy(wire.cloud_detect_s, detection.cloud.detect_s);
}

view_detection_t ToWire(const ViewDetection& detection) {
  auto wire = FieldsToWire<view_detection_t>(detection);
  wire.utime = UtimeOf(detection);
  return wire;
}

void Check(const view_detection_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckName("view", wire.view);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  CheckRange("num_images", wire.num_images, 0, kMaxCameras);
  CheckParts("image", wire.image);
  CheckRange("num_candidates", wire.num_candidates, 0, kMaxCandidates);
  CheckParts("candidate", wire.candidate);
  CheckText("cloud_why_not", wire.cloud_why_not);
  CheckNotNegative("cloud_detect_s", wire.cloud_detect_s);
  if (wire.cloud_why_not.empty() && wire.num_candidates == 0) {
    Fail("cloud_why_not", std::string("empty"), "a reason, as there is no candidate");
  }
}

ViewDetection FromWire(const view_detection_t& wire) { return FieldsFromWire<ViewDetection>(wire); }

}  // namespace rgbdt
