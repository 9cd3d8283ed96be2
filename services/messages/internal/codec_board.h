#pragma once

// Inside the codec: the parts of an observation that are structs of their own, and the board in a
// cloud, which two types tell under the same names. As in codec_types.h: ToWire, Check, FromWire.

#include <lcmtypes/rgbdt/board_crossing_t.hpp>
#include <lcmtypes/rgbdt/board_scatter_t.hpp>
#include <lcmtypes/rgbdt/cloud_board_t.hpp>
#include <lcmtypes/rgbdt/image_side_t.hpp>
#include <lcmtypes/rgbdt/target_pose_t.hpp>
#include <limits>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "calib/model/view_detection.h"
#include "services/messages/check.h"
#include "services/messages/internal/codec_geometry.h"

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

cloud_board_t ToWire(const CloudEdges& cloud);
void Check(const cloud_board_t& wire);
CloudEdges FromWire(const cloud_board_t& wire);

/// Of a board whose other fields another type tells: ScatterFromWire adds to them.
board_scatter_t ScatterToWire(const CloudEdges& cloud);
void Check(const board_scatter_t& wire);
/// `cloud` has as many crossings as `wire` has sigmas.
void ScatterFromWire(const board_scatter_t& wire, CloudEdges* cloud);

/// Check, and what is wrong is told with the part that it lies in: "candidate[2]: width_m is ...".
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

template <typename Struct>
auto PartsToWire(const std::vector<Struct>& parts) {
  std::vector<decltype(ToWire(parts[0]))> wires;
  wires.reserve(parts.size());
  for (const Struct& part : parts) wires.push_back(ToWire(part));
  return wires;
}

template <typename Wire>
auto PartsFromWire(const std::vector<Wire>& wires) {
  std::vector<decltype(FromWire(wires[0]))> parts;
  parts.reserve(wires.size());
  for (const Wire& wire : wires) parts.push_back(FromWire(wire));
  return parts;
}

/// The board in the cloud, without pose and crossings: `Wire` is observation_t or cloud_board_t.
template <typename Wire>
void BoardToWire(const CloudEdges& cloud, Wire* wire) {
  wire->num_boundary = CountOf(cloud.boundary.size(), "num_boundary");
  wire->boundary_m = RowsToWire(cloud.boundary);
  VectorToWire(cloud.centre, wire->centre_m);
  VectorToWire(cloud.normal, wire->normal);
  wire->width_m = cloud.width_m;
  wire->height_m = cloud.height_m;
  wire->spacing_m = cloud.spacing_m;
  wire->num_board_points = cloud.points;
}

template <typename Wire>
void CheckBoard(const Wire& wire) {
  CheckRows("boundary_m", wire.boundary_m);
  CheckFinite("centre_m", wire.centre_m, 3);
  CheckUnitVector("normal", Eigen::Vector3d(wire.normal));
  CheckNotNegative("width_m", wire.width_m);
  CheckNotNegative("height_m", wire.height_m);
  CheckNotNegative("spacing_m", wire.spacing_m);
  CheckRange("num_board_points", wire.num_board_points, 0,
             std::numeric_limits<std::int32_t>::max());
}

template <typename Wire>
CloudEdges BoardFromWire(const Wire& wire) {
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

}  // namespace rgbdt
