#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/image.h"
#include "calib/simulate/internal/lens_table.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// Renders one camera by shooting a ray through each pixel, and n x n where an edge runs through
/// it. The scene without the board is rendered once; a view renders again only what board, stand
/// and their shadows may have changed.
class CameraRenderer {
 public:
  CameraRenderer(const CameraOptions& camera, const Rigid3& camera_from_lidar, int supersampling,
                 int threads);

  const CameraOptions& options() const { return camera_; }
  const Rigid3& camera_from_lidar() const { return camera_from_lidar_; }
  Eigen::Vector3d CentreInLidar() const { return eye_.origin; }
  /// From now on each row is exposed from where the camera is then: camera_from_lidar by the row.
  void Roll(const std::function<Rigid3(int row)>& camera_from_lidar);
  const LensTable& lens() const { return lens_; }

  /// The scene without the board.
  void RenderEmpty(const World& empty);
  bool has_empty() const { return !empty_.empty(); }
  /// The image of `world`, which is the empty scene plus a board; RenderEmpty() comes first.
  void Render(const World& world) { RenderBands({&world}); }
  /// As a rolling shutter sees it: of so many bands of rows, as even as can be, each has a world of
  /// its own, the scene with the board where it is then.
  void RenderBands(const std::vector<const World*>& bands);
  /// Makes the empty scene the image.
  void ShowEmpty(const World& empty);

  /// The image without noise, blur included: DN of the Bayer mosaic, or counts; CV_32FC1.
  const cv::Mat& clean() const { return clean_; }
  /// The image with the noise of (seed, utime) and the dead pixels of the seed. Camera's name,
  /// utime, exposure, format and pixels are filled in.
  Image Take(std::uint64_t seed, Utime utime) const;

 private:
  /// Where a row's rays start, and how the camera is turned then.
  struct Eye {
    explicit Eye(const Rigid3& camera_from_lidar);
    Eigen::Vector3d Direction(const Eigen::Vector2d& normalised) const;
    Eigen::Vector3d origin;
    Eigen::Matrix3d rotation;  ///< lidar_from_camera
  };
  const Eye& EyeOf(int row) const {
    return rows_.empty() ? eye_ : rows_[static_cast<std::size_t>(row)];
  }
  void ShadeRow(const World& world, int row, const std::vector<std::uint8_t>* moving,
                cv::Mat* values, std::vector<std::uint64_t>* patches,
                std::vector<float>* ranges) const;
  void RefineRow(const World& world, int row, const std::vector<std::uint8_t>* moving,
                 const std::vector<std::uint64_t>& patches, cv::Mat* values) const;
  /// The mean of n x n rays through a pixel. Where the scene has many edges and the first n rays
  /// find none in this pixel, the mean of these.
  Eigen::Vector3d Refined(const World& world, int column, int row, int n) const;
  void MarkMoving(const World& world, int row, std::vector<std::uint8_t>* moving) const;
  void Develop(const World& world, const cv::Mat& values);
  void Kill(std::uint64_t seed, double full_scale, cv::Mat* pixels) const;
  bool color() const { return camera_.kind == CameraKind::kColor; }
  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(camera_.width) +
           static_cast<std::size_t>(column);
  }

  CameraOptions camera_;
  Rigid3 camera_from_lidar_;
  Eye eye_;
  std::vector<Eye> rows_;  ///< of a camera that moves while its shutter rolls
  LensTable lens_;
  int supersampling_, threads_;
  double pixel_rad_;
  cv::Mat empty_;                             ///< CV_32FC3 radiance or CV_32FC1 kelvin
  std::vector<std::uint64_t> empty_patches_;  ///< row by row
  std::vector<float> empty_ranges_;           ///< [m]
  cv::Mat clean_;
  double exposure_s_ = 0;
};

}  // namespace rgbdt::simulate
