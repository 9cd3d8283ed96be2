#include "tests/study/paired_sessions.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/methods/paper/cloud_edges.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "tests/numbers.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using simulate::CloudWorld;
using simulate::Noise;

constexpr int kTriesPerView = 25;  // until the board lies in both images and both methods find it
constexpr int kBandHalf = 2;       // a 5x5 window (paper II-A.1)

std::vector<Eigen::Vector2i> BandAbout(const std::vector<Eigen::Vector2d>& outline, int width,
                                       int height) {
  std::set<std::pair<int, int>> pixels;  // by row, each once
  for (const Eigen::Vector2d& p : outline) {
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    for (int v = std::max(0, y - kBandHalf); v <= std::min(height - 1, y + kBandHalf); ++v) {
      for (int u = std::max(0, x - kBandHalf); u <= std::min(width - 1, x + kBandHalf); ++u) {
        pixels.insert({v, u});
      }
    }
  }
  std::vector<Eigen::Vector2i> out;
  for (const auto& [y, x] : pixels) out.emplace_back(x, y);
  return out;
}

void AddOutline(const Camera& camera, const Target& target, const Rigid3& camera_from_target,
                ImageEdges* image) {
  constexpr int kPieces = 3000;  // a side: no pixel is passed over
  constexpr int kSpared = 25;    // the outline needs no more of them than a detector gives
  const auto corners = target.OutlineCorners();
  std::vector<Eigen::Vector2d> all;
  for (std::size_t side = 0; side < 4; ++side) {
    const auto chain = ProjectSegment(camera, camera_from_target * corners[side],
                                      camera_from_target * corners[(side + 1) % 4], kPieces);
    image->outline_corners[side] = chain.front();
    all.insert(all.end(), chain.begin(), chain.end());
  }
  for (std::size_t i = 0; i < all.size(); i += kSpared) image->outline.push_back(all[i]);
  image->edge_pixels = BandAbout(all, image->width, image->height);
}

class Maker {
 public:
  Maker(const PairedOptions& options, std::uint64_t seed) : paired_(options), seed_(seed) {
    options_.seed = seed;
    options_.scene = static_cast<simulate::Scene>(seed % 3);
    options_.threads = 1;
    for (const simulate::CameraOptions& camera : options_.cameras) {
      session_.rig.cameras.push_back(SpecOf(camera));
      session_.camera_from_lidar.push_back(simulate::DrawCameraFromLidar(camera, seed));
    }
    session_.rig.target = simulate::MakeTarget(options_.board);
    session_.rig.lidar.range_sigma_m = options_.scanner.range_sigma_m;
  }

  PairedSession Make() {
    for (int i = 0; i < paired_.views; ++i) AddView(i);
    return std::move(session_);
  }

 private:
  // The next place of the board where both cameras see it and both methods find it.
  void AddView(int index) {
    for (int tries = 0; tries < kTriesPerView; ++tries) {
      const CloudWorld world(options_, next_pose_++);
      if (SeenByAll(world.lidar_from_target()) && LookAt(world, index)) return;
    }
    throw InputError("study: no place for the board in the images");
  }

  bool SeenByAll(const Rigid3& lidar_from_target) const {
    bool all = true;
    for (std::size_t c = 0; c < session_.rig.cameras.size(); ++c) {
      all &= TrueCorners(session_.rig.cameras[c], session_.rig.target,
                         session_.camera_from_lidar[c] * lidar_from_target)
                 .has_value();
    }
    return all;
  }

  bool LookAt(const CloudWorld& world, int index) {
    const Cloud cloud = world.Sweep(kJune2015 + index);
    ViewDetection by_boards;
    by_boards.view = (index < 9 ? "000" : "00") + std::to_string(index + 1);
    by_boards.sweep_utime = kJune2015 + index;
    by_boards.cloud.candidates =
        FindBoards(cloud, session_.rig.target, OptionsFor(session_.rig.lidar)).candidates;
    if (by_boards.cloud.candidates.empty()) return false;
    for (std::size_t c = 0; c < session_.rig.cameras.size(); ++c) {
      const std::string& camera = session_.rig.cameras[c].name;
      auto image = BoardInImage(session_.rig.cameras[c], session_.rig.target,
                                session_.camera_from_lidar[c] * world.lidar_from_target(),
                                Noise(seed_, index + 1, camera));
      if (!image) return false;
      by_boards.images.push_back({camera, kJune2015 + index, std::move(image), "", 0});
    }
    if (paired_.paper) {
      auto by_paper = ByPaper(cloud, by_boards);
      if (!by_paper) return false;
      session_.by_paper.push_back(std::move(*by_paper));
    }
    session_.by_boards.push_back(std::move(by_boards));
    return true;
  }

  // The same images, and the board in the cloud as each of them tells where it is.
  std::optional<ViewDetection> ByPaper(const Cloud& cloud, ViewDetection seen) const {
    seen.cloud.candidates.clear();
    for (std::size_t c = 0; c < session_.rig.cameras.size(); ++c) {
      auto found =
          DetectCloudEdges(cloud, Camera(session_.rig.cameras[c]), session_.camera_from_lidar[c],
                           seen.images[c].edges->corners, session_.rig.target);
      if (!found.edges) return std::nullopt;
      found.edges->camera = seen.images[c].camera;
      seen.cloud.candidates.push_back(std::move(*found.edges));
    }
    return seen;
  }

  PairedOptions paired_;
  std::uint64_t seed_;
  simulate::Options options_;
  PairedSession session_;
  int next_pose_ = 0;
};

}  // namespace

std::optional<PairedSession> MakePairedSession(const PairedOptions& options, std::uint64_t seed) {
  try {
    return Maker(options, seed).Make();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<ImageEdges> BoardInImage(const CameraSpec& spec, const Target& target,
                                       const Rigid3& camera_from_target, const Noise& noise) {
  const auto truth = TrueCorners(spec, target, camera_from_target);
  if (!truth) return std::nullopt;
  const Camera camera(spec);
  ImageEdges image;
  image.width = spec.width;
  image.height = spec.height;
  image.corners = SampledCorners(*truth, CornerSigma(spec.kind), noise);
  const auto pose = PoseFromCorners(camera, target, image.corners);
  if (!pose) return std::nullopt;
  image.pose = pose->pose;
  image.corner_sigma_px = pose->corner_sigma_px;
  AddOutline(camera, target, camera_from_target, &image);
  return image;
}

std::vector<CameraView> ViewsOfCamera(const std::vector<ViewDetection>& detections,
                                      const std::string& camera) {
  std::vector<CameraView> views;
  for (const ViewDetection& detection : detections) {
    views.push_back(CameraViewOf(camera, detection));
  }
  return views;
}

}  // namespace rgbdt::study
