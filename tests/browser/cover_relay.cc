#include "tests/browser/cover_relay.h"

#include <exception>
#include <optional>
#include <utility>

#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "tests/unit/detect/image/covered_board.h"

namespace rgbdt::browser {
namespace {

class Relay {
 public:
  Relay(const std::string& simulator_url, std::filesystem::path truth, std::string camera)
      : simulator_(simulator_url), truth_(std::move(truth)), camera_(std::move(camera)) {
    bus_.Subscribe("SESSION_COMMAND|RIG",
                   Guarded([this](const std::string& channel, const std::uint8_t* data,
                                  std::size_t size) { FromBus(channel, data, size); }));
    simulator_.Subscribe("(?!SESSION_COMMAND).*",
                         Guarded([this](const std::string& channel, const std::uint8_t* data,
                                        std::size_t size) { FromSimulator(channel, data, size); }));
  }

  void Turn() {
    simulator_.Run(2);
    bus_.Run(2);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  // The bus keeps what a handler throws; this process is to end with it.
  Bus::Handler Guarded(Bus::Handler handler) {
    return [this, handler = std::move(handler)](const std::string& channel,
                                                const std::uint8_t* data, std::size_t size) {
      try {
        handler(channel, data, size);
      } catch (...) {
        failure_ = std::current_exception();
      }
    };
  }

  void FromBus(const std::string& channel, const std::uint8_t* data, std::size_t size) {
    const Message message = Decode(channel, data, size);
    if (const auto* rig = std::get_if<RigText>(&message)) {
      if (!rig_) rig_ = ParseRig(rig->text, "RIG message");
      return;
    }
    const auto& command = std::get<SessionCommand>(message);
    if (command.verb == SessionVerb::kNextPose) pose_.reset();
    if (command.verb == SessionVerb::kSweep) FindBoard(command.view);
    simulator_.Publish(channel, Bytes(data, data + size));
  }

  void FindBoard(const std::string& view) {
    const Truth truth = ReadTruth(truth_);
    const auto found = truth.lidar_from_target.find(view);
    if (found == truth.lidar_from_target.end()) {
      throw InputError(truth_.string() + " has no view \"" + view + "\"");
    }
    pose_ = truth.camera_from_lidar.at(camera_) * found->second;
  }

  void FromSimulator(const std::string& channel, const std::uint8_t* data, std::size_t size) {
    Bytes bytes(data, data + size);
    if (pose_ && rig_ && channel.find("_IMAGE") != std::string::npos) {
      Message message = Decode(channel, data, size);
      auto& image = std::get<Image>(message);
      if (image.camera == camera_) {
        Paint(&image);
        bytes = Encode(message);
      }
    }
    bus_.Publish(channel, bytes);
  }

  // The same in each image: nothing moves during a sweep.
  void Paint(Image* image) const {
    Random random(1);
    PaintCover(Camera(rig_->Camera(camera_)), rig_->target, *pose_, Cover::kBar, 0, &random,
               &image->pixels);
  }

  LcmBus bus_{""}, simulator_;
  std::filesystem::path truth_;
  std::string camera_;
  std::optional<Rig> rig_;
  std::optional<Rigid3> pose_;  // camera_from_target
  std::exception_ptr failure_;
};

}  // namespace

void CoverRelay(const std::string& simulator_url, const std::filesystem::path& truth,
                const std::string& camera) {
  Relay relay(simulator_url, truth, camera);
  while (true) relay.Turn();
}

}  // namespace rgbdt::browser
