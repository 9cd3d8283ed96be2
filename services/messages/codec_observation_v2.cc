#include "services/messages/check.h"
#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMaxCandidates = 100;  // a few are sent; each costs its readers time

void ImageToWire(const ImageEdges& image, observation_v2_t* wire) {
  wire->corner_sigma_px = image.corner_sigma_px;
  wire->has_image_pose = static_cast<std::int8_t>(image.pose.has_value());
  if (image.pose) wire->image_pose = ToWire(*image.pose);
  for (std::size_t i = 0; i < image.sides.size(); ++i) wire->side[i] = ToWire(image.sides[i]);
}

void CloudToWire(const CloudEdges& cloud, observation_v2_t* wire) {
  wire->has_cloud_pose = static_cast<std::int8_t>(cloud.pose.has_value());
  if (cloud.pose) wire->cloud_pose = ToWire(*cloud.pose);
  wire->num_cloud_crossings = CountOf(cloud.crossings.size(), "num_cloud_crossings");
  wire->cloud_crossing = PartsToWire(cloud.crossings);
}

void CheckImage(const observation_v2_t& wire) {
  CheckNotNegative("corner_sigma_px", wire.corner_sigma_px);
  if (wire.has_image_pose != 0) CheckPart("image_pose", wire.image_pose);
  for (std::size_t i = 0; i < 4; ++i) CheckPart(At("side", i), wire.side[i]);
}

void CheckCloud(const observation_v2_t& wire) {
  if (wire.has_cloud_pose != 0) CheckPart("cloud_pose", wire.cloud_pose);
  CheckParts("cloud_crossing", wire.cloud_crossing);
}

void ImageFromWire(const observation_v2_t& wire, ImageEdges* image) {
  image->corner_sigma_px = wire.corner_sigma_px;
  if (wire.has_image_pose != 0) image->pose = FromWire(wire.image_pose);
  for (std::size_t i = 0; i < image->sides.size(); ++i) image->sides[i] = FromWire(wire.side[i]);
}

void CloudFromWire(const observation_v2_t& wire, CloudEdges* cloud) {
  if (wire.has_cloud_pose != 0) cloud->pose = FromWire(wire.cloud_pose);
  cloud->crossings = PartsFromWire(wire.cloud_crossing);
}

}  // namespace

observation_v2_t ToSecondVersion(const Observation& observation) {
  observation_v2_t wire{};
  wire.observation = ToFirstVersion(observation);
  if (observation.image) ImageToWire(*observation.image, &wire);
  if (observation.cloud) CloudToWire(*observation.cloud, &wire);
  wire.num_candidates = CountOf(observation.candidates.size(), "num_candidates");
  wire.candidate = PartsToWire(observation.candidates);
  return wire;
}

void Check(const observation_v2_t& wire) {
  Check(wire.observation);
  if (wire.observation.has_image != 0) CheckImage(wire);
  if (wire.observation.has_cloud != 0) CheckCloud(wire);
  CheckRange("num_candidates", wire.num_candidates, 0, kMaxCandidates);
  CheckParts("candidate", wire.candidate);
}

Observation FromWire(const observation_v2_t& wire) {
  Observation observation = FromWire(wire.observation);
  if (observation.image) ImageFromWire(wire, &*observation.image);
  if (observation.cloud) CloudFromWire(wire, &*observation.cloud);
  observation.candidates = PartsFromWire(wire.candidate);
  return observation;
}

}  // namespace rgbdt
