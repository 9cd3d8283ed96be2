#pragma once

// Inside the codec: the parts of a detection that are structs of their own. As in codec_types.h:
// ToWire, Check, FromWire.

#include <lcmtypes/rgbdt/board_crossing_t.hpp>
#include <lcmtypes/rgbdt/cloud_board_t.hpp>
#include <lcmtypes/rgbdt/image_detection_t.hpp>
#include <lcmtypes/rgbdt/image_side_t.hpp>
#include <lcmtypes/rgbdt/point_group_t.hpp>
#include <lcmtypes/rgbdt/target_pose_t.hpp>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "calib/model/view_detection.h"
#include "services/messages/check.h"

namespace rgbdt {

target_pose_t ToWire(const TargetPose& pose);
void Check(const target_pose_t& wire);
TargetPose FromWire(const target_pose_t& wire);

image_side_t ToWire(const ImageSide& side);
void Check(const image_side_t& wire);
ImageSide FromWire(const image_side_t& wire);

board_crossing_t ToWire(const Crossing& crossing);
void Check(const board_crossing_t& wire);
Crossing FromWire(const board_crossing_t& wire);

point_group_t ToWire(const PointGroup& group);
void Check(const point_group_t& wire);
PointGroup FromWire(const point_group_t& wire);

image_detection_t ToWire(const ImageDetection& image);
void Check(const image_detection_t& wire);
ImageDetection FromWire(const image_detection_t& wire);

cloud_board_t ToWire(const CloudEdges& cloud);
void Check(const cloud_board_t& wire);
CloudEdges FromWire(const cloud_board_t& wire);

/// Check, and an error names the part, too: "candidate[2]: width_m is ...".
template <typename Wire>
void CheckPart(const std::string& part, const Wire& wire) {
  try {
    Check(wire);
  } catch (const InputError& e) {
    throw InputError(part + ": " + e.what());
  }
}

template <typename Wire>
void CheckParts(std::string_view field, const std::vector<Wire>& wires) {
  for (std::size_t i = 0; i < wires.size(); ++i) CheckPart(At(field, i), wires[i]);
}

}  // namespace rgbdt
