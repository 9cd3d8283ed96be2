#include "services/replay/waved_log.h"

#include <algorithm>
#include <map>
#include <utility>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/saturation.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/files/schema/rig_file.h"
#include "calib/fuse/range_correction.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_collector.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"

namespace rgbdt {
namespace {

/// The log's rig and its last calibration of each camera: they come once a second, and later than
/// the first sweeps.
struct Known {
  std::optional<Rig> rig;
  std::map<std::string, CalibrationMessage> cameras;
};

Known FindKnown(const std::string& path) {
  Known known;
  LogReader log(path);
  while (const auto event = log.Next()) {
    if (event->channel != "RIG" && event->channel != "CALIBRATION") continue;
    try {
      const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      if (const auto* text = std::get_if<RigText>(&message); text != nullptr && !known.rig) {
        known.rig = ParseRig(text->text, "RIG");
      }
      if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
        known.cameras[calibration->calibration.camera] = *calibration;
      }
    } catch (const InputError&) {  // counted as the log is read for good
    }
  }
  return known;
}

std::optional<Calibration> CalibrationOf(const Known& known) {
  if (known.cameras.empty()) return std::nullopt;
  Calibration calibration;
  for (const auto& [name, message] : known.cameras) {
    calibration.method = message.method;
    calibration.rig_hash = message.rig_hash;
    calibration.utime = std::max(calibration.utime, message.utime);
    calibration.cameras.push_back(message.calibration);
  }
  return calibration;
}

class Reader {
 public:
  Reader(WavedLog* read, const WavedLogOptions& options) : read_(read), options_(options) {
    std::vector<std::optional<RangeErrors>> errors;
    for (const CameraSpec& spec : read->rig.cameras) {
      WavedCamera camera;
      camera.spec = spec;
      const CameraCalibration* known =
          read->calibration ? read->calibration->Find(spec.name) : nullptr;
      if (known != nullptr && known->converged() && !options.find_poses) {
        camera.spec = known->WithSolvedLens(spec);
        camera.camera_from_lidar = known->camera_from_lidar;
        camera.covariance = known->covariance;
        errors.push_back(known->range_errors);
      } else {
        look_for_boards_ = true;
      }
      read->board.cameras.push_back(std::move(camera));
    }
    read->range_errors = RangeCorrectionFor(errors).errors;
  }

  void Take(const Message& message) {
    if (const auto* chunk = std::get_if<CloudChunk>(&message)) TakeChunk(*chunk);
    if (const auto* image = std::get_if<Image>(&message)) TakeImage(*image);
  }
  bool Full() const {
    return read_->board.sweeps.size() >= options_.most_sweeps || images_ >= options_.most_images ||
           points_ >= options_.most_points;
  }

 private:
  void TakeChunk(const CloudChunk& chunk) {
    sweeps_.Add(chunk);
    const Utime name = chunk.cloud.sweep_utime;
    auto sweep = sweeps_.Complete(name);
    if (!sweep || name == last_sweep_) return;
    last_sweep_ = name;
    if (read_->range_errors) sweep = Corrected(std::move(*sweep), *read_->range_errors);
    WavedSweep waved = TakeWavedSweep(*sweep, options_.most_range_m);
    // Every second one is enough to begin with.
    if (look_for_boards_ && read_->board.sweeps.size() % 2 == 0) FindIn(*sweep, &waved);
    points_ += waved.points.size();
    read_->board.sweeps.push_back(std::move(waved));
  }

  void FindIn(const Cloud& sweep, WavedSweep* waved) const {
    BoardInCloudOptions options;
    options.range_sigma_m = read_->rig.lidar.range_sigma_m;
    options.max_range_m = options_.most_range_m;
    for (const CloudEdges& board : FindBoards(sweep, read_->rig.target, options).candidates) {
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

  void TakeImage(const Image& image) {
    for (WavedCamera& camera : read_->board.cameras) {
      if (camera.spec.name != image.camera) continue;
      CheckImage(camera.spec, image);
      if (image.shutter_correcting) return;
      ++images_;
      const auto found = FindCheckerboard(ToGrey(image), read_->rig.target, SaturatedFrom(image));
      if (found.board) camera.images.push_back({image.utime, found.board->corners});
      return;
    }
  }

  WavedLog* read_;
  WavedLogOptions options_;
  SweepCollector sweeps_;
  bool look_for_boards_ = false;
  Utime last_sweep_ = 0;
  std::size_t images_ = 0, points_ = 0;
};

}  // namespace

WavedLog ReadWavedLog(const std::string& path, const std::optional<Calibration>& calibration,
                      const WavedLogOptions& options, const std::function<void(double)>& progress) {
  const Known known = FindKnown(path);
  if (!known.rig) throw InputError(path + ": no RIG in this log; record that channel, too");
  if (known.rig->lidar.turned_scanner) {
    throw InputError(
        path +
        ": the rig's LIDAR is a turned scanner, whose sweeps last too long for a board "
        "that is waved; expected a spinning LIDAR");
  }
  if (!known.rig->target.HasPattern()) {
    throw InputError(path + ": the rig's target is plain; a waved board needs a checkerboard");
  }
  WavedLog read;
  read.rig = *known.rig;
  read.calibration = calibration ? calibration : CalibrationOf(known);
  if (read.calibration) {
    RequireSameRig(*read.calibration, read.rig, {"the calibration", "the log's RIG"},
                   Use::kIfSound);
  }
  read.board.target = read.rig.target;
  read.board.range_sigma_m = read.rig.lidar.range_sigma_m;
  read.board.range_offset_sigma_m = read.rig.lidar.range_offset_sigma_m;

  Reader reader(&read, options);
  LogReader log(path);
  std::int64_t dropped = 0;
  std::string last_problem;
  while (const auto event = log.Next()) {
    if (progress) progress(static_cast<double>(log.position()) / static_cast<double>(log.size()));
    if (event->channel != "CLOUD" && !IsImageChannel(event->channel)) continue;
    try {
      reader.Take(Decode(event->channel, event->bytes.data(), event->bytes.size()));
    } catch (const InputError& error) {  // as a process does: dropped and counted
      ++dropped;
      last_problem = error.what();
    }
    if (!reader.Full()) continue;
    read.problems.push_back("what comes after " + std::to_string(read.board.sweeps.size()) +
                            " sweeps was not read: that is enough");
    break;
  }
  if (dropped > 0) {
    read.problems.push_back(std::to_string(dropped) +
                            " messages dropped; the last: " + last_problem);
  }
  if (log.unreadable_bytes() > 0) {
    read.problems.push_back(std::to_string(log.unreadable_bytes()) +
                            " bytes belong to no whole message");
  }
  if (read.board.sweeps.empty()) {
    throw InputError(path + ": no whole sweep (CLOUD) with times in this log" +
                     (last_problem.empty() ? "" : "; last problem: " + last_problem));
  }
  return read;
}

}  // namespace rgbdt
