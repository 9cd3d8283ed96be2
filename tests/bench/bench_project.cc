// Points of the LIDAR's frame to pixels of the colour camera.
#include <memory>

#include "calib/camera/project_points.h"
#include "tests/bench/by_opencv.h"
#include "tests/bench/measure.h"
#include "tests/bench/scanned_room.h"
#include "tests/bench/stages.h"
#include "tests/numbers.h"

namespace rgbdt::bench {
namespace {

struct Input {
  CameraSpec spec;
  Rigid3 camera_from_lidar;
  std::vector<Eigen::Vector3f> points;
};

std::shared_ptr<const Input> MakeInput(std::int64_t points) {
  const BenchRig rig = MakeBenchRig();
  return std::make_shared<Input>(Input{rig.rig.cameras.at(0), rig.camera_from_lidar.at(0),
                                       ScannedRoom(kInView, points, kJune2015).points});
}

std::function<void()> Ours(std::int64_t points) {
  return [input = MakeInput(points)] {
    const Camera camera(input->spec);
    const PointProjector projector(camera, input->camera_from_lidar);
    std::vector<Eigen::Vector2f> pixels(input->points.size());
    projector.ForBlocks(ViewBounds(camera), BlockedPoints(input->points), 0, input->points.size(),
                        [&](std::size_t first, std::size_t count, const PixelBlock& block) {
                          for (std::size_t i = 0; i < count; ++i) {
                            pixels[first + i] = {block.u[i], block.v[i]};
                          }
                        });
    benchmark::DoNotOptimize(pixels);
  };
}

std::function<void()> ByOpenCv(std::int64_t points) {
  return [input = MakeInput(points)] {
    auto pixels = ProjectByOpenCv(input->spec, input->camera_from_lidar, input->points);
    benchmark::DoNotOptimize(pixels);
  };
}

}  // namespace

void RegisterProject(std::int64_t most) {
  for (const std::int64_t size : Decades(most)) {
    Register({"project", "rgbdt", size, "points"}, [=] { return Ours(size); });
    Register({"project", "cv::projectPoints", size, "points"}, [=] { return ByOpenCv(size); });
  }
}

}  // namespace rgbdt::bench
