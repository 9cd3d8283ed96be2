#include "calib/simulate/internal/lens_table.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "calib/model/errors.h"

namespace rgbdt::simulate {
namespace {

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

Distorted ApplyDistortion(const std::array<double, 8>& k, const Eigen::Vector2d& p) {
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double top = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double bottom = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double top_slope = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);  // by r2
  const double bottom_slope = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
  const double c = top / bottom;
  const double c_slope = (top_slope * bottom - top * bottom_slope) / (bottom * bottom);
  Distorted d;
  d.point = {c * x + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
             c * y + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  const double cross = 2 * c_slope * x * y + 2 * k[2] * x + 2 * k[3] * y;
  d.jacobian << c + 2 * c_slope * x * x + 2 * k[2] * y + 6 * k[3] * x, cross, cross,
      c + 2 * c_slope * y * y + 6 * k[2] * y + 2 * k[3] * x;
  return d;
}

std::array<Eigen::Vector2d, 4> ImageCorners(int width, int height) {
  return {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(width - 0.5, -0.5),
          Eigen::Vector2d(width - 0.5, height - 0.5), Eigen::Vector2d(-0.5, height - 0.5)};
}

}  // namespace

LensTable::LensTable(const Lens& lens, int width, int height)
    : lens_(lens), width_(width), height_(height) {
  for (const Eigen::Vector2d& corner : ImageCorners(width, height)) {
    // Step out from the middle, so that Newton starts near its root however strong the lens.
    Eigen::Vector2d guess(0, 0);
    const Eigen::Vector2d middle(lens.cx, lens.cy);
    for (int i = 1; i <= 16; ++i) {
      guess = Undistort(middle + (corner - middle) * (i / 16.0), guess);
    }
    max_radius_ = std::max(max_radius_, guess.norm());
  }
}

Eigen::Vector2d LensTable::Distort(const Eigen::Vector2d& normalised) const {
  const Eigen::Vector2d d = ApplyDistortion(lens_.distortion, normalised).point;
  return {lens_.fx * d.x() + lens_.cx, lens_.fy * d.y() + lens_.cy};
}

Eigen::Vector2d LensTable::Undistort(const Eigen::Vector2d& pixel,
                                     const Eigen::Vector2d& start) const {
  const Eigen::Vector2d wanted((pixel.x() - lens_.cx) / lens_.fx,
                               (pixel.y() - lens_.cy) / lens_.fy);
  Eigen::Vector2d p = start;
  for (int i = 0; i < 20; ++i) {
    const Distorted d = ApplyDistortion(lens_.distortion, p);
    const Eigen::Vector2d step = d.jacobian.inverse() * (wanted - d.point);
    p += step;
    if (!(step.squaredNorm() > 1e-26)) break;
  }
  return p;
}

std::optional<Eigen::Vector2d> LensTable::Project(const Eigen::Vector3d& point_in_camera) const {
  if (point_in_camera.z() <= 1e-3) return std::nullopt;
  const Eigen::Vector2d normalised = point_in_camera.head<2>() / point_in_camera.z();
  if (normalised.norm() > max_radius_) return std::nullopt;
  return Distort(normalised);
}

void LensTable::Fill() {
  table_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  // Outwards from the principal point, each pixel from its neighbour nearer to it.
  const int column0 = std::clamp(static_cast<int>(lens_.cx), 0, width_ - 1);
  const int row0 = std::clamp(static_cast<int>(lens_.cy), 0, height_ - 1);
  const auto cell = [this](int column, int row) -> Eigen::Vector2d& {
    return table_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(column)];
  };
  const auto fill_row = [&](int row, const Eigen::Vector2d& start) {
    cell(column0, row) = Undistort(Eigen::Vector2d(column0, row), start);
    for (int c = column0 + 1; c < width_; ++c) {
      cell(c, row) = Undistort(Eigen::Vector2d(c, row), cell(c - 1, row));
    }
    for (int c = column0 - 1; c >= 0; --c) {
      cell(c, row) = Undistort(Eigen::Vector2d(c, row), cell(c + 1, row));
    }
  };
  fill_row(row0, {0, 0});
  for (int row = row0 + 1; row < height_; ++row) fill_row(row, cell(column0, row - 1));
  for (int row = row0 - 1; row >= 0; --row) fill_row(row, cell(column0, row + 1));
}

void CheckLens(const Lens& lens, int width, int height, const std::string& field) {
  if (lens.model != Lens::Model::kPinhole) {
    throw InputError("simulator: " + field + " is a fisheye; the simulator knows pinhole only");
  }
  const LensTable table(lens, width, height);
  const Eigen::Vector2d middle(lens.cx, lens.cy);
  for (const Eigen::Vector2d& corner : ImageCorners(width, height)) {
    Eigen::Vector2d point(0, 0);
    for (int i = 1; i <= 64; ++i) {
      const Eigen::Vector2d pixel = middle + (corner - middle) * (i / 64.0);
      point = table.Undistort(pixel, point);
      const Distorted d = ApplyDistortion(lens.distortion, point);
      const bool folds = !(d.jacobian.determinant() > 0.01) || !(d.jacobian.trace() > 0) ||
                         !((table.Distort(point) - pixel).norm() < 1e-6);
      if (!folds) continue;
      throw InputError("simulator: " + field + " distortion folds back at pixel (" +
                       std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) +
                       "), inside the image; take smaller coefficients");
    }
  }
}

}  // namespace rgbdt::simulate
