#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// How far apart a LIDAR's neighbouring points lie in a camera's image: medians over beams of a
/// line and over lines, staggered or not, whether all rings fire at a time or in turn, of organised
/// clouds by their directions alone (as if all were far away), so that neither the scene nor how
/// the rig moves has a say. Takes clouds line by line or as a whole and looks at a sample of their
/// points; bounded in memory.
class PointSpacing {
 public:
  explicit PointSpacing(const Camera& camera) : camera_(camera) {}

  void Add(const Cloud& cloud, const Rigid3& camera_from_lidar);

  /// The cells that hold about one point of a surface each [px], for DepthBuffer.
  Eigen::Vector2d CellPx() const;

 private:
  // Of distances, by their logarithm.
  class Histogram {
   public:
    void Add(double distance_px);
    double Median() const;  // 0: none
    bool empty() const { return count_ == 0; }

   private:
    std::array<int, 64> bins_{};
    int count_ = 0;
  };
  struct Pair {
    Histogram u, v;
    void Add(const Eigen::Vector2d& apart);
  };

  void AddOrganised(const Cloud& cloud, const Eigen::Quaterniond& camera_from_lidar);
  void AddUnorganised(const Cloud& cloud, const Rigid3& camera_from_lidar);
  std::optional<Eigen::Vector2d> PixelOf(const Eigen::Vector3d& point_in_camera) const;

  Camera camera_;
  Pair beams_, lines_;
  double unorganised_px_ = 0;
  std::vector<Eigen::Vector3f> line_before_;  // where clouds are single lines
  int line_before_number_ = -2;
};

}  // namespace rgbdt
