#include "services/messages/internal/codec_board.h"

namespace rgbdt {

target_pose_t ToWire(const TargetPose& pose) {
  target_pose_t wire;
  RigidToWire(pose.sensor_from_target, wire.quaternion_wxyz, wire.translation_m);
  MatrixToWire(pose.covariance, wire.covariance);
  wire.half_turn_known = static_cast<std::int8_t>(pose.half_turn_known);
  return wire;
}

void Check(const target_pose_t& wire) {
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  CheckCovariance("covariance", wire.covariance[0], 6);
}

TargetPose FromWire(const target_pose_t& wire) {
  return {RigidFromWire(wire.quaternion_wxyz, wire.translation_m), MatrixFromWire(wire.covariance),
          wire.half_turn_known != 0};
}

image_side_t ToWire(const ImageSide& side) {
  image_side_t wire;
  wire.seen = static_cast<std::int8_t>(side.seen);
  wire.why = side.why;
  wire.num_curve = CountOf(side.curve.size(), "num_curve");
  wire.curve_px = RowsToWire(side.curve);
  MatrixToWire(side.covariance, wire.covariance_px2);
  return wire;
}

void Check(const image_side_t& wire) {
  CheckText("why", wire.why);
  CheckRows("curve_px", wire.curve_px);
  CheckCovariance("covariance_px2", wire.covariance_px2[0], 2);
  // The covariance speaks of the curve's two ends.
  if (wire.seen != 0 && wire.num_curve < 2) {
    Fail("num_curve", wire.num_curve, "2 or more, as the side is seen");
  }
}

ImageSide FromWire(const image_side_t& wire) {
  return {wire.seen != 0, wire.why, RowsFromWire<Eigen::Vector2d>(wire.curve_px),
          MatrixFromWire(wire.covariance_px2)};
}

board_crossing_t ToWire(const Crossing& crossing) {
  board_crossing_t wire;
  VectorToWire(crossing.point, wire.point_m);
  wire.half_width_m = crossing.half_width_m;
  // Before it is cut to the wire's byte.
  CheckRange("side", crossing.side, board_crossing_t::TOP, board_crossing_t::LEFT);
  wire.side = static_cast<std::int8_t>(crossing.side);
  wire.kind = static_cast<std::int8_t>(crossing.kind);
  return wire;
}

void Check(const board_crossing_t& wire) {
  CheckFinite("point_m", wire.point_m, 3);
  CheckNotNegative("half_width_m", wire.half_width_m);
  CheckRange("side", wire.side, board_crossing_t::TOP, board_crossing_t::LEFT);
  CheckRange("kind", wire.kind, board_crossing_t::NO_RETURN, board_crossing_t::MERGED);
}

Crossing FromWire(const board_crossing_t& wire) {
  return {Eigen::Vector3d(wire.point_m), wire.half_width_m, wire.side,
          static_cast<CrossingKind>(wire.kind)};
}

cloud_board_t ToWire(const CloudEdges& cloud) {
  cloud_board_t wire{};
  BoardToWire(cloud, &wire);
  wire.has_pose = static_cast<std::int8_t>(cloud.pose.has_value());
  if (cloud.pose) wire.pose = ToWire(*cloud.pose);
  wire.num_crossings = CountOf(cloud.crossings.size(), "num_crossings");
  wire.crossing = PartsToWire(cloud.crossings);
  return wire;
}

void Check(const cloud_board_t& wire) {
  CheckBoard(wire);
  if (wire.has_pose != 0) CheckPart("pose", wire.pose);
  CheckParts("crossing", wire.crossing);
}

CloudEdges FromWire(const cloud_board_t& wire) {
  CloudEdges cloud = BoardFromWire(wire);
  if (wire.has_pose != 0) cloud.pose = FromWire(wire.pose);
  cloud.crossings = PartsFromWire(wire.crossing);
  return cloud;
}

board_scatter_t ScatterToWire(const CloudEdges& cloud) {
  board_scatter_t wire;
  wire.num_crossings = CountOf(cloud.crossings.size(), "num_crossings");
  wire.crossing_sigma_m.reserve(cloud.crossings.size());
  for (const Crossing& crossing : cloud.crossings) {
    wire.crossing_sigma_m.push_back(crossing.sigma_m);
  }
  MatrixToWire(cloud.scatter, wire.scatter);
  MatrixToWire(cloud.raw_scatter, wire.raw_scatter);
  wire.scatter_sigma_m = cloud.scatter_sigma_m;
  return wire;
}

void Check(const board_scatter_t& wire) {
  for (std::size_t i = 0; i < wire.crossing_sigma_m.size(); ++i) {
    CheckNotNegative(At("crossing_sigma_m", i), wire.crossing_sigma_m[i]);
  }
  CheckCovariance("scatter", wire.scatter[0], 4);
  CheckCovariance("raw_scatter", wire.raw_scatter[0], 4);
  CheckNotNegative("scatter_sigma_m", wire.scatter_sigma_m);
}

void ScatterFromWire(const board_scatter_t& wire, CloudEdges* cloud) {
  for (std::size_t i = 0; i < cloud->crossings.size(); ++i) {
    cloud->crossings[i].sigma_m = wire.crossing_sigma_m[i];
  }
  cloud->scatter = MatrixFromWire(wire.scatter);
  cloud->raw_scatter = MatrixFromWire(wire.raw_scatter);
  cloud->scatter_sigma_m = wire.scatter_sigma_m;
}

}  // namespace rgbdt
