#include "calib/detect/image/internal/board_map.h"

#include <Eigen/LU>
#include <cmath>

namespace rgbdt {
namespace {

constexpr double kLeastZ = 0.05;  // of a unit direction: 87 degrees off the axis

// The homography that takes four points to four others; nothing where three are on a line.
std::optional<Eigen::Matrix3d> HomographyOf(const std::array<Eigen::Vector2d, 4>& from,
                                            const std::array<Eigen::Vector2d, 4>& to) {
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& p = from[static_cast<std::size_t>(i)];
    const Eigen::Vector2d& q = to[static_cast<std::size_t>(i)];
    a.row(2 * i) << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y();
    a.row(2 * i + 1) << 0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y();
    b.segment<2>(2 * i) = q;
  }
  const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
  if (!h.allFinite()) return std::nullopt;
  Eigen::Matrix3d homography;
  homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return homography;
}

}  // namespace

BoardMap MapByPose(const Camera& camera, const Rigid3& camera_from_target) {
  return [&camera, camera_from_target](const Eigen::Vector2d& p) {
    return camera.Project(camera_from_target * Eigen::Vector3d(p.x(), p.y(), 0));
  };
}

std::optional<BoardMap> MapByOutline(const Camera& camera, const Target& target,
                                     const std::array<Eigen::Vector2d, 4>& outline) {
  std::array<Eigen::Vector2d, 4> on_board;
  std::array<Eigen::Vector2d, 4> seen;
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto direction = camera.Unproject(outline[i]);
    if (!direction || direction->z() < kLeastZ) return std::nullopt;
    on_board[i] = corners[i].head<2>();
    seen[i] = direction->head<2>() / direction->z();
  }
  const auto homography = HomographyOf(on_board, seen);
  if (!homography) return std::nullopt;
  return [&camera, h = *homography](const Eigen::Vector2d& p) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector3d direction = h * p.homogeneous();
    if (!(direction.z() > 0)) return std::nullopt;
    return camera.Project(direction / direction.z());
  };
}

std::optional<GridPlace> GridAt(const BoardMap& map, const Eigen::Vector2d& on_board,
                                double square_m) {
  GridPlace grid;
  const auto here = map(on_board);
  if (!here) return std::nullopt;
  grid.place = *here;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = square_m * Eigen::Vector2d::Unit(axis);
    const auto near_before = map(on_board - 0.5 * step);
    const auto near_after = map(on_board + 0.5 * step);
    const auto before = map(on_board - step);
    const auto after = map(on_board + step);
    if (!near_before || !near_after || !before || !after) return std::nullopt;
    grid.steps.col(axis) = *near_after - *near_before;
    grid.bends.col(axis) = *after - 2 * *here + *before;
  }
  return grid;
}

}  // namespace rgbdt
