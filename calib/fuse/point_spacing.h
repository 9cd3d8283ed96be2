#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "calib/camera/project_points.h"
#include "calib/model/cloud.h"

namespace rgbdt {

/// How far apart a LIDAR's neighbouring points lie in a camera's image: medians over beams of a
/// line and over lines. Takes clouds line by line or as a whole; bounded in memory.
class PointSpacing {
 public:
  explicit PointSpacing(const Camera& camera);

  /// `grid`: where each of the pixels' points stands in the cloud.
  void Add(const Cloud& cloud, const std::vector<std::uint32_t>& grid, const PixelColumns& pixels);

  /// The cells that hold about one point of a surface each [px], for DepthBuffer.
  Eigen::Vector2d CellPx() const;

 private:
  // Of distances, by their logarithm.
  class Histogram {
   public:
    void Add(float distance_px);
    double Median() const;  // 0: none
    bool empty() const { return count_ == 0; }

   private:
    std::array<int, 64> bins_{};
    int count_ = 0;
  };
  struct Pair {
    Histogram u, v;
    void Add(const PixelColumns& pixels, std::size_t i, float u, float v);
  };
  struct Pixel {
    float u = 0, v = 0;
    bool seen = false;
  };

  void AddOrganised(const Cloud& cloud, const std::vector<std::uint32_t>& grid,
                    const PixelColumns& pixels);
  void AddUnorganised(const PixelColumns& pixels);
  bool InImage(const PixelColumns& pixels, std::size_t i) const;

  int width_, height_;
  Pair beams_, lines_;
  double unorganised_px_ = 0;
  std::vector<Pixel> line_before_;
  int line_before_number_ = -2;
};

}  // namespace rgbdt
