#include "calib/sync/internal/image_motion.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/camera/target_pose.h"

namespace rgbdt::sync {
namespace {

// Jitter of a sensor's noise alone moves corners by more.
constexpr double kSamePx = 1e-2;

bool SameAgain(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (IsSeen(a[i]) != IsSeen(b[i])) return false;
    if (IsSeen(a[i]) && (a[i] - b[i]).cwiseAbs().maxCoeff() > kSamePx) return false;
  }
  return true;
}

double MiddleRow(const std::vector<Eigen::Vector2d>& corners, int height) {
  double sum = 0;
  int seen = 0;
  for (const Eigen::Vector2d& corner : corners) {
    if (!IsSeen(corner)) continue;
    sum += RowShare(corner.y(), height);
    ++seen;
  }
  return sum / seen;
}

std::optional<PosedImage> PoseImage(const Camera& camera, const Target& target,
                                    const WavedImage& image) {
  // A rolling shutter bends the board: no corner is left out for that.
  const auto found = PoseFromCorners(camera, target, image.corners, 0.2);
  if (!found || found->second_pose_chi2 < 10) return std::nullopt;
  PosedImage posed{image.utime, image.corners, found->pose.sensor_from_target,
                   found->corner_sigma_px, 0};
  for (std::size_t i = 0; i < posed.corners.size(); ++i) {
    if (!found->used[i]) posed.corners[i] = UnseenCorner();
  }
  posed.middle_row = MiddleRow(posed.corners, camera.height());
  return posed;
}

// A pixel and its slope by the point.
struct Seen {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> slope;
};

Seen Project(const Lens& lens, const Eigen::Vector3d& point) {
  using Jet = ceres::Jet<double, 3>;
  Jet u;
  Jet v;
  ProjectUnchecked(lens, Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2), &u, &v);
  Seen seen;
  seen.pixel = {u.a, v.a};
  seen.slope << u.v.transpose(), v.v.transpose();
  return seen;
}

}  // namespace

void TurnByHalf(PosedImage* image) {
  std::reverse(image->corners.begin(), image->corners.end());
  image->camera_from_target =
      image->camera_from_target * RotationAbout(Eigen::Vector3d::UnitZ(), M_PI);
}

std::vector<PosedImage> PoseImages(const Camera& camera, const Target& target,
                                   const std::vector<WavedImage>& images, int* repeated) {
  std::vector<const WavedImage*> by_time;
  by_time.reserve(images.size());
  for (const WavedImage& image : images) by_time.push_back(&image);
  std::stable_sort(by_time.begin(), by_time.end(),
                   [](const WavedImage* a, const WavedImage* b) { return a->utime < b->utime; });
  std::vector<PosedImage> posed;
  const WavedImage* before = nullptr;
  for (const WavedImage* image : by_time) {
    if (before != nullptr &&
        (image->utime == before->utime || SameAgain(image->corners, before->corners))) {
      ++*repeated;
      continue;
    }
    before = image;
    auto found = PoseImage(camera, target, *image);
    if (!found) continue;
    if (!posed.empty() &&
        RotationDistance(found->camera_from_target, posed.back().camera_from_target) > 0.5 * M_PI) {
      TurnByHalf(&*found);
    }
    posed.push_back(std::move(*found));
  }
  return posed;
}

Quadratic LineariseImage(const Camera& camera, const Target& target, const PosedImage& image,
                         double sigma_px, const PoseByRow& at) {
  QuadraticSum sum;
  const std::vector<Eigen::Vector3d> corners = target.InnerCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!IsSeen(image.corners[i])) continue;
    const double later = RowShare(image.corners[i].y(), camera.height()) - image.middle_row;
    const Eigen::Vector3d point = at(later) * corners[i];
    if (point.z() < 0.05) continue;
    const Seen seen = Project(camera.lens(), point);
    Eigen::Matrix<double, 3, 6> moved;
    moved << -CrossMatrix(point), Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 2, 6> slope = seen.slope * moved / sigma_px;
    const Eigen::Vector2d off = (seen.pixel - image.corners[i]) / sigma_px;
    for (int k = 0; k < 2; ++k) {
      Quadratic::Vector row;
      row << slope.row(k).transpose(), later * slope.row(k).transpose(), 0;
      sum.Add(row, off[k]);
    }
  }
  return sum.Root();
}

}  // namespace rgbdt::sync
