#include "calib/simulate/internal/camera_renderer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/shading.h"

namespace rgbdt::simulate {
namespace {

void Store(const Eigen::Vector3d& value, int row, int column, cv::Mat* values) {
  if (values->channels() == 1) {
    values->at<float>(row, column) = static_cast<float>(value[0]);
  } else {
    values->at<cv::Vec3f>(row, column) = {
        static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
  }
}

/// Radiance of the brightest white of the board; without a board, of a white sheet 3 m ahead.
double BrightestWhite(const World& world) {
  unsigned shadows = 0;
  const std::optional<double>& white = world.scene().white;
  if (!world.board() && white) return *white;
  if (!world.board()) return 0.7 * Irradiance(world, {3, 0, 0}, {-1, 0, 0}, &shadows).maxCoeff();
  const Board& board = *world.board();
  const Eigen::Vector3d normal = board.lidar_from_target().rotation * Eigen::Vector3d(0, 0, -1);
  double brightest = 1e-6;
  for (const double x : {-0.48, -0.24, 0.0, 0.24, 0.48}) {
    for (const double y : {-0.48, -0.24, 0.0, 0.24, 0.48}) {
      const Eigen::Vector3d place(x * board.options().width_m, y * board.options().height_m, 0);
      brightest = std::max(
          brightest,
          Irradiance(world, board.lidar_from_target() * place, normal, &shadows).maxCoeff());
    }
  }
  return std::max(brightest * board.options().white_reflectivity, white.value_or(0));
}

/// Row and column of a pixel in the 2 x 2 cell R G / G B -> channel of blue green red.
int BayerChannel(int row, int column) { return 2 - (row & 1) - (column & 1); }

}  // namespace

CameraRenderer::CameraRenderer(const CameraOptions& camera, const Rigid3& camera_from_lidar,
                               int supersampling, int threads)
    : camera_(camera),
      camera_from_lidar_(camera_from_lidar),
      eye_(camera_from_lidar),
      lens_(camera.lens, camera.width, camera.height),
      supersampling_(supersampling),
      threads_(threads),
      pixel_rad_(1 / std::max(camera.lens.fx, camera.lens.fy)) {}

CameraRenderer::Eye::Eye(const Rigid3& camera_from_lidar)
    : origin(camera_from_lidar.Inverse().translation),
      rotation(camera_from_lidar.Inverse().rotation.toRotationMatrix()) {}

Eigen::Vector3d CameraRenderer::Eye::Direction(const Eigen::Vector2d& normalised) const {
  return (rotation * normalised.homogeneous()).normalized();
}

void CameraRenderer::Roll(const std::function<Rigid3(int row)>& camera_from_lidar) {
  rows_.clear();
  for (int row = 0; row < camera_.height; ++row) rows_.emplace_back(camera_from_lidar(row));
}

void CameraRenderer::MarkMoving(const World& world, int row,
                                std::vector<std::uint8_t>* moving) const {
  const Eye& eye = EyeOf(row);
  for (int column = 0; column < camera_.width; ++column) {
    const Eigen::Vector3d direction = eye.Direction(lens_.At(column, row));
    const std::size_t i = Index(column, row);
    bool may = world.MayMeetMoving(eye.origin, direction);
    if (!may && color() && std::isfinite(empty_ranges_[i])) {
      may = MayBeShadedByMoving(world, eye.origin + empty_ranges_[i] * direction);
    }
    (*moving)[i] = may ? 1 : 0;
  }
}

void CameraRenderer::ShadeRow(const World& world, int row, const std::vector<std::uint8_t>* moving,
                              cv::Mat* values, std::vector<std::uint64_t>* patches,
                              std::vector<float>* ranges) const {
  const Eye& eye = EyeOf(row);
  for (int column = 0; column < camera_.width; ++column) {
    const std::size_t i = Index(column, row);
    if (moving != nullptr && (*moving)[i] == 0) continue;
    const Eigen::Vector3d direction = eye.Direction(lens_.At(column, row));
    const Seen seen = color() ? SeeColor(world, eye.origin, direction, pixel_rad_)
                              : SeeHeat(world, eye.origin, direction, pixel_rad_);
    Store(seen.value, row, column, values);
    (*patches)[i] = seen.patch;
    if (ranges != nullptr) (*ranges)[i] = static_cast<float>(seen.range);
  }
}

Eigen::Vector3d CameraRenderer::Refined(const World& world, int column, int row, int n) const {
  const Eye& eye = EyeOf(row);
  const bool few_first = world.scene().many_edges;
  Eigen::Vector3d sum(0, 0, 0);
  std::uint64_t patch = 0;
  bool edge = false;
  for (int k = 0; k < n * n; ++k) {
    // With few rays first, these are spread over the pixel: no two in a row or a column of n.
    const int i = few_first ? k % n : k / n;
    const int j = few_first ? (i * (1 + n % 2) + k / n) % n : k % n;
    // All n^2 columns and n^2 rows of the fine grid hold one ray each (canonical stratified
    // arrangement), so an upright edge is placed to 1/n^2 of a pixel.
    const Eigen::Vector2d pixel(column - 0.5 + (i + (j + 0.5) / n) / n,
                                row - 0.5 + (j + (i + 0.5) / n) / n);
    const Eigen::Vector3d direction = eye.Direction(lens_.Undistort(pixel, lens_.At(column, row)));
    const Seen seen = color() ? SeeColor(world, eye.origin, direction, pixel_rad_)
                              : SeeHeat(world, eye.origin, direction, pixel_rad_);
    sum += seen.value;
    edge |= k > 0 && seen.patch != patch;
    patch = seen.patch;
    if (few_first && k + 1 == n && !edge) return sum / n;
  }
  return sum / (n * n);
}

void CameraRenderer::RefineRow(const World& world, int row, const std::vector<std::uint8_t>* moving,
                               const std::vector<std::uint64_t>& patches, cv::Mat* values) const {
  constexpr int kLeafySupersampling = 3;
  for (int column = 0; column < camera_.width; ++column) {
    const std::uint64_t own = patches[Index(column, row)];
    bool edge = false;
    bool leafy = false;
    bool changed = moving == nullptr;
    for (int r = std::max(0, row - 1); r <= std::min(camera_.height - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(camera_.width - 1, column + 1); ++c) {
        edge |= patches[Index(c, r)] != own;
        leafy |= (patches[Index(c, r)] & kLeafyPatch) != 0;
        changed |= moving != nullptr && (*moving)[Index(c, r)] != 0;
      }
    }
    if (!edge || !changed) continue;
    // Edges are everywhere among leaves, and few rays place them well enough.
    const int n = leafy ? std::min(supersampling_, kLeafySupersampling) : supersampling_;
    Store(Refined(world, column, row, n), row, column, values);
  }
}

void CameraRenderer::RenderEmpty(const World& empty) {
  if (!lens_.filled()) lens_.Fill();
  const std::size_t pixels = Index(0, camera_.height);
  cv::Mat values(camera_.height, camera_.width, color() ? CV_32FC3 : CV_32FC1);
  empty_patches_.resize(pixels);
  empty_ranges_.resize(pixels);
  ForEach(camera_.height, threads_, [&](int row) {
    ShadeRow(empty, row, nullptr, &values, &empty_patches_, &empty_ranges_);
  });
  ForEach(camera_.height, threads_,
          [&](int row) { RefineRow(empty, row, nullptr, empty_patches_, &values); });
  empty_ = values;
}

void CameraRenderer::RenderBands(const std::vector<const World*>& bands) {
  const auto count = static_cast<int>(bands.size());
  const auto world_of = [&](int row) -> const World& {
    return *bands[static_cast<std::size_t>(row * count / camera_.height)];
  };
  cv::Mat values = empty_.clone();
  std::vector<std::uint64_t> patches = empty_patches_;
  std::vector<std::uint8_t> moving(patches.size());
  ForEach(camera_.height, threads_, [&](int row) {
    MarkMoving(world_of(row), row, &moving);
    ShadeRow(world_of(row), row, &moving, &values, &patches, nullptr);
  });
  ForEach(camera_.height, threads_,
          [&](int row) { RefineRow(world_of(row), row, &moving, patches, &values); });
  Develop(world_of(camera_.height / 2), values);
}

void CameraRenderer::ShowEmpty(const World& empty) { Develop(empty, empty_); }

void CameraRenderer::Develop(const World& world, const cv::Mat& values) {
  cv::Mat blurred = values;
  if (camera_.blur_px > 0) {
    const int side = 2 * static_cast<int>(std::ceil(4 * camera_.blur_px)) + 1;
    cv::GaussianBlur(values, blurred, {side, side}, camera_.blur_px, camera_.blur_px,
                     cv::BORDER_REPLICATE);
  }
  clean_.create(camera_.height, camera_.width, CV_32FC1);
  exposure_s_ = camera_.exposure_s;
  const double white = color() ? BrightestWhite(world) : 1;
  if (color()) exposure_s_ *= 0.7 / white;
  for (int row = 0; row < camera_.height; ++row) {
    float* out = clean_.ptr<float>(row);
    for (int column = 0; column < camera_.width; ++column) {
      out[column] = static_cast<float>(
          color() ? blurred.at<cv::Vec3f>(row, column)[BayerChannel(row, column)] *
                        (camera_.white_dn / white)
                  : (blurred.at<float>(row, column) - camera_.offset_k) / camera_.gain_k);
    }
  }
}

void CameraRenderer::Kill(std::uint64_t seed, double full_scale, cv::Mat* pixels) const {
  const Noise noise(seed, 0, camera_.name + " dead pixels");
  for (int i = 0; i < camera_.dead_pixels; ++i) {
    const auto number = static_cast<std::uint64_t>(3 * i);
    const int column = static_cast<int>(noise.Uniform(number, 0, camera_.width));
    const int row = static_cast<int>(noise.Uniform(number + 1, 0, camera_.height));
    const double value = noise.Uniform(number + 2) < 0.5 ? 0 : full_scale;
    pixels->row(row).col(column).setTo(value);
  }
}

Image CameraRenderer::Take(std::uint64_t seed, Utime utime) const {
  Image image;
  image.camera = camera_.name;
  image.utime = utime;
  image.exposure_s = exposure_s_;
  image.format = color() ? PixelFormat::kBayerRg8 : PixelFormat::kMono16;
  image.pixels.create(camera_.height, camera_.width, color() ? CV_8UC1 : CV_16UC1);
  const Noise noise(seed, utime, camera_.name);
  const auto sigma =
      static_cast<float>(color() ? camera_.noise_dn : camera_.netd_k / camera_.gain_k);
  const auto top = static_cast<float>(color() ? 255 : (1 << camera_.bits) - 1);
  for (int row = 0; row < camera_.height; ++row) {
    const float* clean = clean_.ptr<float>(row);
    for (int column = 0; column < camera_.width; column += 2) {
      float error[2];
      noise.NormalPair(Index(column, row) / 2, &error[0], &error[1]);
      for (int k = 0; k < 2; ++k) {
        const float value = std::clamp(clean[column + k] + sigma * error[k] + 0.5F, 0.0F, top);
        if (color()) {
          image.pixels.at<std::uint8_t>(row, column + k) = static_cast<std::uint8_t>(value);
        } else {
          image.pixels.at<std::uint16_t>(row, column + k) = static_cast<std::uint16_t>(value);
        }
      }
    }
  }
  Kill(seed, top, &image.pixels);
  return image;
}

}  // namespace rgbdt::simulate
