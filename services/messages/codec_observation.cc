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

void CheckImage(const observation_v3_t& wire) {
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
  if (wire.has_image_pose != 0) CheckPart("image_pose", wire.image_pose);
  for (std::size_t i = 0; i < 4; ++i) CheckPart(At("side", i), wire.side[i]);
}

}  // namespace

// All but the edge pixels, ints that must fit into 16 bits.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, observation_v3_t>& wire,
            StructOf<Copy, ImageEdges>& image) {
  copy(wire.image_width, image.width);
  copy(wire.image_height, image.height);
  copy(wire.picked, image.picked);
  copy(wire.outline_corner_px, image.outline_corners);
  copy.List("num_corners", wire.num_corners, wire.corner_px, image.corners);
  copy(wire.corner_sigma_px, image.corner_sigma_px);
  copy.List("num_outline", wire.num_outline, wire.outline_px, image.outline);
  copy.Optional(wire.has_image_pose, wire.image_pose, image.pose);
  copy(wire.side, image.sides);
}

// All but the image.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, observation_v3_t>& wire,
            StructOf<Copy, Observation>& observation) {
  copy(wire.utime, observation.image_utime);
  copy(wire.seq, observation.seq);
  copy(wire.view, observation.view);
  copy(wire.camera, observation.camera);
  copy(wire.sweep_utime, observation.sweep_utime);
  copy(wire.heldout, observation.heldout);
  copy(wire.rejected, observation.rejected);
  copy(wire.detect_image_s, observation.detect_image_s);
  copy(wire.detect_cloud_s, observation.detect_cloud_s);
  copy.Optional(wire.has_cloud, wire.cloud, observation.cloud);
  copy.List("num_candidates", wire.num_candidates, wire.candidate, observation.candidates);
}

observation_v3_t ToWire(const Observation& observation) {
  auto wire = FieldsToWire<observation_v3_t>(observation);
  if (!observation.image) return wire;
  const ImageEdges& image = *observation.image;
  wire.has_image = 1;
  Fields(CopyToWire(), wire, image);
  wire.num_edge_pixels = CountOf(image.edge_pixels.size(), "num_edge_pixels");
  wire.edge_pixel.reserve(image.edge_pixels.size());
  for (const Eigen::Vector2i& pixel : image.edge_pixels) {
    CheckRange("edge_pixel x", pixel.x(), 0, image.width - 1);
    CheckRange("edge_pixel y", pixel.y(), 0, image.height - 1);
    wire.edge_pixel.push_back(
        {static_cast<std::int16_t>(pixel.x()), static_cast<std::int16_t>(pixel.y())});
  }
  return wire;
}

void Check(const observation_v3_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckName("view", wire.view);
  CheckCameraName("camera", wire.camera);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  CheckText("rejected", wire.rejected);
  CheckNotNegative("detect_image_s", wire.detect_image_s);
  CheckNotNegative("detect_cloud_s", wire.detect_cloud_s);
  if (wire.has_image != 0) CheckImage(wire);
  if (wire.has_cloud != 0) CheckPart("cloud", wire.cloud);
  if (wire.rejected.empty() && (wire.has_image == 0 || wire.has_cloud == 0)) {
    Fail("rejected", std::string("empty"), "a reason, as image or cloud is missing");
  }
  CheckRange("num_candidates", wire.num_candidates, 0, kMaxCandidates);
  CheckParts("candidate", wire.candidate);
}

Observation FromWire(const observation_v3_t& wire) {
  auto observation = FieldsFromWire<Observation>(wire);
  if (wire.has_image == 0) return observation;
  ImageEdges& image = observation.image.emplace();
  Fields(CopyFromWire(), wire, image);
  image.edge_pixels.reserve(wire.edge_pixel.size());
  for (const std::vector<std::int16_t>& pixel : wire.edge_pixel) {
    image.edge_pixels.emplace_back(pixel[0], pixel[1]);
  }
  return observation;
}

}  // namespace rgbdt
