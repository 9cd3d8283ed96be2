#include "calib/files/schema/internal/target_convert.h"

#include <string>

#include "calib/files/schema/proto_convert.h"
#include "calib/model/beam_priors.h"
#include "calib/model/text.h"

namespace rgbdt::text {
namespace {

void ToCharuco(const proto::Charuco& charuco, const Place& place, Target* spec) {
  if (charuco.squares_x() == 0) place.Fail("squares_x", "is 0; expected 3 to 100");
  if (charuco.dictionary().empty()) {
    place.Fail("dictionary", "is missing; expected one of " + MarkerFamilyNames());
  }
  spec->squares_x = charuco.squares_x();
  spec->squares_y = charuco.squares_y();
  spec->square_m = charuco.square_m();
  spec->markers = Markers{charuco.dictionary(), charuco.marker_m(), 1, 0, charuco.legacy()};
}

void ToAprilGrid(const proto::AprilGrid& grid, const Place& place, Target* spec) {
  if (grid.tags_x() < 2 || grid.tags_x() > 49) {
    place.Fail("tags_x", "is " + std::to_string(grid.tags_x()) + "; expected 2 to 49");
  }
  if (grid.tags_y() < 2 || grid.tags_y() > 49) {
    place.Fail("tags_y", "is " + std::to_string(grid.tags_y()) + "; expected 2 to 49");
  }
  if (!(grid.spacing() > 0 && grid.spacing() < 2)) {
    place.Fail("spacing", "is " + Exact(grid.spacing()) +
                              "; expected the gap over tag_m, as Kalibr's tagSpacing: 0.3 or so");
  }
  Markers markers;
  markers.family = "APRILTAG_" + (grid.family().empty() ? "36h11" : grid.family());
  markers.side_m = grid.tag_m();
  markers.gap_m = grid.spacing() * grid.tag_m();
  markers.border_bits = grid.border_bits() == 0 ? kKalibrBorderBits : grid.border_bits();
  *spec = GridOfMarkers(grid.tags_x(), grid.tags_y(), markers);
}

// Sizes that are not stated are velo2cam's and FAST-Calib's.
void ToBoardWithHoles(const proto::BoardWithHoles& board, Target* spec) {
  Holes holes;
  if (board.has_first_marker()) holes.first_marker = board.first_marker();
  if (board.has_hole_radius_m()) holes.radius_m = board.hole_radius_m();
  if (board.has_hole_spacing_x_m()) holes.spacing_m.x() = board.hole_spacing_x_m();
  if (board.has_hole_spacing_y_m()) holes.spacing_m.y() = board.hole_spacing_y_m();
  if (board.has_marker_spacing_x_m()) holes.marker_spacing_m.x() = board.marker_spacing_x_m();
  if (board.has_marker_spacing_y_m()) holes.marker_spacing_m.y() = board.marker_spacing_y_m();
  Markers markers;
  markers.family = board.dictionary().empty() ? kHolesFamily : board.dictionary();
  markers.side_m = board.marker_m();
  *spec = BoardWithHoles(markers, holes);
}

void FromBoardWithHoles(const Markers& markers, const Holes& holes, proto::BoardWithHoles* out) {
  out->set_marker_m(markers.side_m);
  out->set_dictionary(ValidUtf8(markers.family));
  out->set_first_marker(holes.first_marker);
  out->set_hole_radius_m(holes.radius_m);
  out->set_hole_spacing_x_m(holes.spacing_m.x());
  out->set_hole_spacing_y_m(holes.spacing_m.y());
  out->set_marker_spacing_x_m(holes.marker_spacing_m.x());
  out->set_marker_spacing_y_m(holes.marker_spacing_m.y());
}

void FromCharuco(const Target& spec, const Markers& markers, proto::Charuco* out) {
  out->set_squares_x(spec.squares_x);
  out->set_squares_y(spec.squares_y);
  out->set_square_m(spec.square_m);
  out->set_marker_m(markers.side_m);
  out->set_dictionary(ValidUtf8(markers.family));
  out->set_legacy(markers.legacy);
}

void FromAprilGrid(const Target& spec, const Markers& markers, proto::AprilGrid* out) {
  const std::string prefix = "APRILTAG_";
  out->set_tags_x(spec.squares_x / 2);
  out->set_tags_y(spec.squares_y / 2);
  out->set_tag_m(markers.side_m);
  out->set_spacing(markers.gap_m / markers.side_m);
  out->set_family(ValidUtf8(markers.family.substr(
      markers.family.compare(0, prefix.size(), prefix) == 0 ? prefix.size() : 0)));
  out->set_border_bits(markers.border_bits);
}

}  // namespace

Target ToTarget(const proto::Target& target, const Place& place) {
  Target spec;
  const bool squares = target.squares_x() != 0 || target.squares_y() != 0 || target.square_m() != 0;
  const int kinds = (target.has_plain() ? 1 : 0) + (target.has_charuco() ? 1 : 0) +
                    (target.has_aprilgrid() ? 1 : 0) + (target.has_holes() ? 1 : 0);
  if (target.has_plain()) {
    if (kinds > 1 || squares || target.width_m() != 0 || target.height_m() != 0 ||
        target.pattern_offset_m_size() > 0 || target.has_print_sigma()) {
      place.Fail("plain", "stands beside a checkerboard's fields; expected one of the two");
    }
    spec.width_m = target.plain().width_m();
    spec.height_m = target.plain().height_m();
    return spec;
  }
  if (kinds > 1 || (kinds > 0 && squares)) {
    place.Fail(target.has_charuco()     ? "charuco"
               : target.has_aprilgrid() ? "aprilgrid"
                                        : "holes",
               "stands beside another board's fields; expected one board");
  }
  if (target.has_charuco()) {
    ToCharuco(target.charuco(), place.In("charuco"), &spec);
  } else if (target.has_aprilgrid()) {
    ToAprilGrid(target.aprilgrid(), place.In("aprilgrid"), &spec);
  } else if (target.has_holes()) {
    ToBoardWithHoles(target.holes(), &spec);
  } else if (target.squares_x() == 0) {
    place.Fail("squares_x",
               "is 0; expected 3 to 100, or charuco { ... }, aprilgrid { ... }, holes { ... } or "
               "plain { width_m: ... height_m: ... }");
  } else {
    spec.squares_x = target.squares_x();
    spec.squares_y = target.squares_y();
    spec.square_m = target.square_m();
  }
  // A board with holes has a usual size.
  if (!spec.holes || target.width_m() != 0) spec.width_m = target.width_m();
  if (!spec.holes || target.height_m() != 0) spec.height_m = target.height_m();
  spec.print_sigma = target.has_print_sigma() ? target.print_sigma() : kUsualPrintSigma;
  if (target.pattern_offset_m_size() > 0) {
    RequireNumbers(target.pattern_offset_m(), 2, place, "pattern_offset_m");
    spec.pattern_offset_m = {target.pattern_offset_m(0), target.pattern_offset_m(1)};
  }
  return spec;
}

void FromTarget(const Target& spec, proto::Target* out) {
  if (!spec.HasPattern()) {
    out->mutable_plain()->set_width_m(spec.width_m);
    out->mutable_plain()->set_height_m(spec.height_m);
    return;
  }
  if (!spec.markers) {
    out->set_squares_x(spec.squares_x);
    out->set_squares_y(spec.squares_y);
    out->set_square_m(spec.square_m);
  } else if (spec.holes) {
    FromBoardWithHoles(*spec.markers, *spec.holes, out->mutable_holes());
  } else if (spec.markers->grid()) {
    FromAprilGrid(spec, *spec.markers, out->mutable_aprilgrid());
  } else {
    FromCharuco(spec, *spec.markers, out->mutable_charuco());
  }
  out->set_width_m(spec.width_m);
  out->set_height_m(spec.height_m);
  out->set_print_sigma(spec.print_sigma);
  if (spec.pattern_offset_m.isZero(0)) return;
  out->add_pattern_offset_m(spec.pattern_offset_m.x());
  out->add_pattern_offset_m(spec.pattern_offset_m.y());
}

}  // namespace rgbdt::text
