#include "services/replay/wave_reader.h"

#include <utility>
#include <variant>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/saturation.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/fuse/range_correction.h"
#include "calib/model/errors.h"

namespace rgbdt {

std::string WhyNotWaved(const Rig& rig) {
  if (rig.lidar.turned_scanner) {
    return "the rig's LIDAR is a turned scanner, whose sweeps last too long for a waved board; "
           "expected a spinning LIDAR";
  }
  if (!rig.target.HasPattern()) {
    return "the rig's target is plain; a waved board needs a pattern";
  }
  return {};
}

WaveReader::WaveReader(const Rig& rig, const std::optional<Calibration>& calibration,
                       const WavedLogOptions& options)
    : options_(options) {
  if (const std::string why = WhyNotWaved(rig); !why.empty()) throw InputError(why);
  read_.rig = rig;
  read_.calibration = calibration;
  if (calibration) {
    RequireSameRig(*calibration, rig, {"the calibration", "the RIG message"}, Use::kIfSound);
  }
  read_.board.target = rig.target;
  read_.board.range_sigma_m = rig.lidar.range_sigma_m;
  read_.board.range_offset_sigma_m = rig.lidar.range_offset_sigma_m;
  std::vector<std::optional<RangeErrors>> errors;
  for (const CameraSpec& spec : rig.cameras) {
    WavedCamera camera;
    camera.spec = spec;
    const CameraCalibration* known = calibration ? calibration->Find(spec.name) : nullptr;
    if (known != nullptr && known->converged() && !options.find_poses) {
      camera.spec = known->WithSolvedLens(spec);
      camera.camera_from_lidar = known->camera_from_lidar;
      camera.covariance = known->covariance;
      errors.push_back(known->range_errors);
    } else {
      look_for_boards_ = true;
    }
    read_.board.cameras.push_back(std::move(camera));
  }
  read_.range_errors = RangeCorrectionFor(errors).errors;
}

void WaveReader::Take(const Message& message) {
  if (const auto* chunk = std::get_if<CloudChunk>(&message)) TakeChunk(*chunk);
  if (const auto* image = std::get_if<Image>(&message)) TakeImage(*image);
}

bool WaveReader::Full() const {
  return read_.board.sweeps.size() >= options_.most_sweeps || images_ >= options_.most_images ||
         points_ >= options_.most_points;
}

void WaveReader::TakeChunk(const CloudChunk& chunk) {
  sweeps_.Add(chunk);
  const Utime name = chunk.cloud.sweep_utime;
  auto sweep = sweeps_.Complete(name);
  if (!sweep || name == last_sweep_) return;
  last_sweep_ = name;
  if (read_.range_errors) sweep = Corrected(std::move(*sweep), *read_.range_errors);
  WavedSweep waved = TakeWavedSweep(*sweep, options_.most_range_m);
  // Every second one is enough to begin with.
  if (look_for_boards_ && read_.board.sweeps.size() % 2 == 0) FindIn(*sweep, &waved);
  points_ += waved.points.size();
  read_.board.sweeps.push_back(std::move(waved));
}

void WaveReader::FindIn(const Cloud& sweep, WavedSweep* waved) const {
  BoardInCloudOptions options = OptionsFor(read_.rig.lidar);
  options.max_range_m = options_.most_range_m;
  for (const CloudEdges& board : FindBoards(sweep, read_.rig.target, options).candidates) {
    if (!board.pose) continue;
    const Rigid3& pose = board.pose->sensor_from_target;
    const Eigen::Vector3f towards = pose.translation.normalized().cast<float>();
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < waved->points.size(); ++i) {
      if (waved->points[i].normalized().dot(towards) >
          waved->points[nearest].normalized().dot(towards)) {
        nearest = i;
      }
    }
    if (!waved->points.empty()) waved->boards.push_back({waved->utime[nearest], pose});
  }
}

void WaveReader::TakeImage(const Image& image) {
  for (WavedCamera& camera : read_.board.cameras) {
    if (camera.spec.name != image.camera) continue;
    CheckImage(camera.spec, image);
    if (image.shutter_correcting) return;
    ++images_;
    const auto found = FindCheckerboard(ToGrey(image), read_.rig.target, SaturatedFrom(image));
    if (found.board) camera.images.push_back({image.utime, found.board->corners});
    return;
  }
}

}  // namespace rgbdt
