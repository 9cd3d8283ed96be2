#include "services/messages/internal/codec_board.h"

#include <limits>

#include "calib/model/range_errors.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, target_pose_t>& wire, StructOf<Copy, TargetPose>& pose) {
  copy.Pose(wire.quaternion_wxyz, wire.translation_m, pose.sensor_from_target);
  copy(wire.covariance, pose.covariance);
  copy(wire.half_turn_known, pose.half_turn_known);
}

target_pose_t ToWire(const TargetPose& pose) { return FieldsToWire<target_pose_t>(pose); }

void Check(const target_pose_t& wire) {
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
  CheckCovariance("covariance", wire.covariance[0], 6);
}

TargetPose FromWire(const target_pose_t& wire) { return FieldsFromWire<TargetPose>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, image_side_t>& wire, StructOf<Copy, ImageSide>& side) {
  copy(wire.seen, side.seen);
  copy(wire.why, side.why);
  copy.List("num_curve", wire.num_curve, wire.curve_px, side.curve);
  copy(wire.covariance_px2, side.covariance);
}

image_side_t ToWire(const ImageSide& side) { return FieldsToWire<image_side_t>(side); }

void Check(const image_side_t& wire) {
  CheckText("why", wire.why);
  CheckRows("curve_px", wire.curve_px);
  CheckCovariance("covariance_px2", wire.covariance_px2[0], 2);
  // The covariance is that of the curve's two ends.
  if (wire.seen != 0 && wire.num_curve < 2) {
    Fail("num_curve", wire.num_curve, "2 or more, as the side is seen");
  }
}

ImageSide FromWire(const image_side_t& wire) { return FieldsFromWire<ImageSide>(wire); }

// All but the side, an int that must fit into a byte.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, board_crossing_t>& wire,
            StructOf<Copy, Crossing>& crossing) {
  copy(wire.point_m, crossing.point);
  copy(wire.half_width_m, crossing.half_width_m);
  copy(wire.sigma_m, crossing.sigma_m);
  copy(wire.kind, crossing.kind);
}

board_crossing_t ToWire(const Crossing& crossing) {
  CheckRange("side", crossing.side, board_crossing_t::TOP, board_crossing_t::LEFT);
  auto wire = FieldsToWire<board_crossing_t>(crossing);
  wire.side = static_cast<std::int8_t>(crossing.side);
  return wire;
}

void Check(const board_crossing_t& wire) {
  CheckFinite("point_m", wire.point_m, 3);
  CheckNotNegative("half_width_m", wire.half_width_m);
  CheckNotNegative("sigma_m", wire.sigma_m);
  CheckRange("side", wire.side, board_crossing_t::TOP, board_crossing_t::LEFT);
  CheckRange("kind", wire.kind, board_crossing_t::NO_RETURN, board_crossing_t::MERGED);
}

Crossing FromWire(const board_crossing_t& wire) {
  auto crossing = FieldsFromWire<Crossing>(wire);
  crossing.side = static_cast<unsigned char>(wire.side);  // 0 to 3, as checked
  return crossing;
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, point_group_t>& wire,
            StructOf<Copy, PointGroup>& group) {
  copy(wire.ring, group.ring);
  copy(wire.log2_intensity, group.log2_intensity);
  copy(wire.scatter, group.scatter);
}

point_group_t ToWire(const PointGroup& group) { return FieldsToWire<point_group_t>(group); }

void Check(const point_group_t& wire) {
  CheckRange("ring", wire.ring, -1, kMostLasers - 1);
  if (!(wire.log2_intensity >= kLeastLog2Intensity && wire.log2_intensity <= 0)) {
    Fail("log2_intensity", wire.log2_intensity, "-16 to 0");
  }
  CheckCovariance("scatter", wire.scatter[0], 4);
}

PointGroup FromWire(const point_group_t& wire) { return FieldsFromWire<PointGroup>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, cloud_board_t>& wire,
            StructOf<Copy, CloudEdges>& cloud) {
  copy(wire.camera, cloud.camera);
  copy.List("num_boundary", wire.num_boundary, wire.boundary_m, cloud.boundary);
  copy(wire.centre_m, cloud.centre);
  copy(wire.normal, cloud.normal);
  copy(wire.width_m, cloud.width_m);
  copy(wire.height_m, cloud.height_m);
  copy(wire.spacing_m, cloud.spacing_m);
  copy(wire.num_board_points, cloud.points);
  copy.Optional(wire.has_pose, wire.pose, cloud.pose);
  copy.List("num_crossings", wire.num_crossings, wire.crossing, cloud.crossings);
  copy(wire.scatter, cloud.scatter);
  copy(wire.raw_scatter, cloud.raw_scatter);
  copy(wire.scatter_sigma_m, cloud.scatter_sigma_m);
  copy.List("num_groups", wire.num_groups, wire.group, cloud.groups);
  copy(wire.group_sigma_m, cloud.group_sigma_m);
  copy(wire.turn_rad_s, cloud.turn_rad_s);
}

cloud_board_t ToWire(const CloudEdges& cloud) { return FieldsToWire<cloud_board_t>(cloud); }

void Check(const cloud_board_t& wire) {
  if (!wire.camera.empty()) CheckCameraName("camera", wire.camera);
  CheckRows("boundary_m", wire.boundary_m);
  CheckFinite("centre_m", wire.centre_m, 3);
  CheckUnitVector("normal", Eigen::Vector3d(wire.normal));
  CheckNotNegative("width_m", wire.width_m);
  CheckNotNegative("height_m", wire.height_m);
  CheckNotNegative("spacing_m", wire.spacing_m);
  CheckRange("num_board_points", wire.num_board_points, 0,
             std::numeric_limits<std::int32_t>::max());
  if (wire.has_pose != 0) CheckPart("pose", wire.pose);
  CheckParts("crossing", wire.crossing);
  CheckCovariance("scatter", wire.scatter[0], 4);
  CheckCovariance("raw_scatter", wire.raw_scatter[0], 4);
  CheckNotNegative("scatter_sigma_m", wire.scatter_sigma_m);
  CheckParts("group", wire.group);
  CheckNotNegative("group_sigma_m", wire.group_sigma_m);
  CheckFinite("turn_rad_s", wire.turn_rad_s);
}

CloudEdges FromWire(const cloud_board_t& wire) { return FieldsFromWire<CloudEdges>(wire); }

}  // namespace rgbdt
