#include "calib/fuse/point_spacing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/unit/fuse/small_camera.h"

namespace rgbdt {
namespace {

// Lines one above the other before the camera, a degree apart, their beams a third of one; those of
// every second line lie so many beams beside the others'. What they meet lies near and far.
Cloud Lines(int staggered_beams) {
  Cloud cloud;
  cloud.organised = true;
  cloud.lines = 30;
  cloud.beams = 180;
  for (int line = 0; line < cloud.lines; ++line) {
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const int column = beam + (line % 2) * staggered_beams;
      const double azimuth = (column / 3.0 - 30) * M_PI / 180;
      const double elevation = (line - 15) * M_PI / 180;
      const double range = 2 + (beam / 7 + line) % 5;
      // Camera axes: x right, y down, z forward.
      const Eigen::Vector3d direction(std::sin(azimuth) * std::cos(elevation), -std::sin(elevation),
                                      std::cos(azimuth) * std::cos(elevation));
      cloud.points.emplace_back((range * direction).cast<float>());
    }
  }
  return cloud;
}

// The same points column by column.
Cloud Columns(int staggered_beams) {
  const Cloud by_line = Lines(staggered_beams);
  Cloud cloud = by_line;
  std::swap(cloud.lines, cloud.beams);
  for (int column = 0; column < cloud.lines; ++column) {
    for (int line = 0; line < cloud.beams; ++line) {
      cloud.points[static_cast<std::size_t>(column * cloud.beams + line)] =
          by_line.points[static_cast<std::size_t>(line * cloud.lines + column)];
    }
  }
  return cloud;
}

constexpr double kFocal = 500;

CameraSpec Spec() {
  CameraSpec spec = test::SpecOf(CameraKind::kColor);
  spec.width = 800;
  spec.height = 600;
  spec.lens = {Lens::Model::kPinhole, kFocal, kFocal, 400, 300, {}};
  return spec;
}

Eigen::Vector2d CellsOf(const Cloud& cloud) {
  PointSpacing spacing{Camera(Spec())};
  spacing.Add(cloud, {});
  return spacing.CellPx();
}

TEST(PointSpacing, IsThatOfBeamsAlongLinesAndOfLines) {
  const Eigen::Vector2d cell = CellsOf(Lines(0));
  // A tenth more than the spacing, which the histogram tells to 9%; wider beside the middle.
  EXPECT_NEAR(cell.x(), 1.2 * kFocal * M_PI / 180 / 3, 0.2 * kFocal * M_PI / 180 / 3);
  EXPECT_NEAR(cell.y(), 1.2 * kFocal * M_PI / 180, 0.2 * kFocal * M_PI / 180);
}

// As an Ouster's rings are, by up to six degrees.
TEST(PointSpacing, StaggeredLinesHaveTheCellsOfOnesThatAreNot) {
  const Eigen::Vector2d straight = CellsOf(Lines(0));
  for (const Cloud& cloud : {Lines(17), Lines(-16), Columns(0), Columns(17), Columns(-6)}) {
    const Eigen::Vector2d cell = CellsOf(cloud);
    EXPECT_NEAR(cell.x(), straight.x(), 0.25 * straight.x());
    EXPECT_NEAR(cell.y(), straight.y(), 0.25 * straight.y());
  }
}

TEST(PointSpacing, OfRingsThatFireInTurnIsThatOfTheBeamsThatWereFired) {
  const Eigen::Vector2d all = CellsOf(Lines(0));
  for (const bool by_line : {false, true}) {
    Cloud cloud = Lines(0);
    cloud.directions = cloud.points;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::size_t line = i / 180, beam = i % 180;
      if ((beam + (by_line ? line : 0)) % 2 == 0) continue;
      cloud.points[i] = cloud.directions[i] = Eigen::Vector3f::Constant(NAN);
    }
    const Eigen::Vector2d cell = CellsOf(cloud);
    EXPECT_NEAR(cell.x(), 2 * all.x(), 0.25 * all.x()) << by_line;
    EXPECT_NEAR(cell.y(), all.y(), 0.25 * all.y()) << by_line;
  }
}

}  // namespace
}  // namespace rgbdt
