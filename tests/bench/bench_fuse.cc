// All that touches calib/fuse: demosaicing and fusing, beside OpenCV.
#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calib/fuse/sweep_fuser.h"
#include "tests/bench/by_opencv.h"
#include "tests/bench/measure.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/stages.h"
#include "tests/numbers.h"

namespace rgbdt::bench {
namespace {

constexpr std::int64_t kPointsByCameras = 100'000;

// The rig's two cameras in turn, each with a name of its own.
struct Scene {
  std::vector<CameraSpec> specs;
  std::vector<Rigid3> camera_from_lidar;
  std::vector<Image> images;
  Cloud cloud;
};

Scene MakeScene(const Field& field, std::int64_t points, int cameras) {
  const BenchRig rig = MakeBenchRig();
  Scene scene;
  for (int c = 0; c < cameras; ++c) {
    const std::size_t like = static_cast<std::size_t>(c) % rig.rig.cameras.size();
    scene.specs.push_back(rig.rig.cameras[like]);
    scene.specs.back().name += std::to_string(c);
    scene.camera_from_lidar.push_back(rig.camera_from_lidar[like]);
    scene.images.push_back(PictureOf(scene.specs.back(), kJune2015, c));
  }
  scene.cloud = ScannedRoom(field, points, kJune2015 + kMicrosecondsPerSecond / 10);
  return scene;
}

// A field in view is to be just that, but for the few that a corner of the room might hide.
void RequireSeen(const RgbdtCloud& fused, const Field& field, int cameras) {
  std::size_t seen = 0;
  const std::uint32_t all = (1U << cameras) - 1;
  for (const std::uint32_t valid : fused.valid) seen += valid == all ? 1U : 0U;
  const double share = static_cast<double>(seen) / static_cast<double>(fused.size());
  const bool in_view = field.wide == kInView.wide;
  if (in_view ? share < 0.9 : share < 0.1 || share > 0.2) {
    throw std::runtime_error("all cameras see " + std::to_string(share) + " of the points");
  }
}

// One camera's depth buffer: filled by all points, closed, and asked of each.
std::function<void()> Visibility(std::int64_t points) {
  const Scene scene = MakeScene(kInView, points, 1);
  const Camera camera(scene.specs[0]);
  const auto buffer = std::make_shared<DepthBuffer>(camera, Eigen::Vector2d(5.5, 5.5), 0.01);
  const auto blocks = std::make_shared<std::vector<std::pair<PixelBlock, std::size_t>>>();
  PointProjector(camera, scene.camera_from_lidar[0])
      .ForBlocks(ViewBounds(camera), BlockedPoints(scene.cloud.points), 0, scene.cloud.size(),
                 [&](std::size_t, std::size_t count, const PixelBlock& block) {
                   blocks->push_back({block, count});
                 });
  return [=] {
    buffer->Clear();
    for (const auto& [block, count] : *blocks) buffer->Add(block, count);
    buffer->Close();
    std::size_t hidden = 0;
    for (const auto& [block, count] : *blocks) {
      std::uint8_t is_hidden[PixelBlock::kSize];
      buffer->FindOccluded(*buffer, {block.u, block.v, block.inverse_range}, count, is_hidden);
      hidden += static_cast<std::size_t>(std::count(is_hidden, is_hidden + count, 1));
    }
    benchmark::DoNotOptimize(hidden);
  };
}

// What the live fuser does with a chunk.
std::function<void()> Ours(const Field& field, std::int64_t points, int cameras) {
  const Scene scene = MakeScene(field, points, cameras);
  const auto cloud = std::make_shared<Cloud>(scene.cloud);
  const auto fuser = std::make_shared<SweepFuser>(scene.specs, 0.01);
  for (std::size_t c = 0; c < scene.specs.size(); ++c) {
    fuser->camera(c).AddImage(Prepare(scene.specs[c], scene.images[c]));
    fuser->SetCalibration(c,
                          {scene.specs[c].name, scene.camera_from_lidar[c], std::nullopt,
                           SolveStatus::kConverged, ""},
                          kJune2015);
  }
  RequireSeen(fuser->FuseChunk(*cloud), field, cameras);
  return [=] {
    ++cloud->sweep_utime;  // the next sweep
    RgbdtCloud fused = fuser->FuseChunk(*cloud);
    benchmark::DoNotOptimize(fused);
  };
}

std::function<void()> ByOpenCv(const Field& field, std::int64_t points, int cameras) {
  const Scene scene = MakeScene(field, points, cameras);
  std::vector<CameraForOpenCv> with_pixels;
  for (std::size_t c = 0; c < scene.specs.size(); ++c) {
    cv::Mat pixels = scene.images[c].pixels;
    if (scene.specs[c].kind == CameraKind::kColor) {
      cv::cvtColor(scene.images[c].pixels, pixels, cv::COLOR_BayerBG2BGR);
    }
    with_pixels.push_back({scene.specs[c], scene.camera_from_lidar[c], pixels});
  }
  const auto all_points = std::make_shared<const std::vector<Eigen::Vector3f>>(scene.cloud.points);
  return [=] {
    ColouredByOpenCv fused = FuseByOpenCv(*all_points, with_pixels);
    benchmark::DoNotOptimize(fused);
  };
}

void RegisterBoth(const char* row, const Field& field, std::int64_t points, int cameras) {
  Register({row, "rgbdt", points, "points", cameras}, [=] { return Ours(field, points, cameras); });
  Register({row, "cv::projectPoints + loop", points, "points", cameras},
           [=] { return ByOpenCv(field, points, cameras); });
}

void RegisterDemosaic() {
  const CameraSpec spec = MakeBenchRig().rig.cameras.at(0);
  const auto image = std::make_shared<const Image>(PictureOf(spec, kJune2015, 0));
  const std::int64_t pixels = std::int64_t{spec.width} * spec.height;
  Register({"demosaic", "rgbdt", pixels, "pixels"}, [=] {
    return [=] {
      PreparedImage prepared = Prepare(spec, *image);
      benchmark::DoNotOptimize(prepared);
    };
  });
  Register({"demosaic", "cv::cvtColor", pixels, "pixels"}, [=] {
    return [=] {
      cv::Mat bgr;
      cv::cvtColor(image->pixels, bgr, cv::COLOR_BayerBG2BGR);
      benchmark::DoNotOptimize(bgr.data);
    };
  });
}

}  // namespace

void RegisterFuse(std::int64_t most) {
  RegisterDemosaic();
  for (const std::int64_t size : Decades(most)) {
    Register({"visibility", "rgbdt", size, "points", 1}, [=] { return Visibility(size); });
    RegisterBoth("fuse_in_view", kInView, size, 2);
    RegisterBoth("fuse_360", kAllRound, size, 2);
  }
  for (const int cameras : {1, 2, 4, 8}) {
    RegisterBoth("fuse_by_cameras", kInView, kPointsByCameras, cameras);
  }
}

}  // namespace rgbdt::bench
