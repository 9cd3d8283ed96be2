// What the processes of a rig make of messages that anybody may send, well-formed ones: the first
// byte says which process, and what rig it has heard; then come messages (feed_node.h).
#include "calib/files/schema/rig_file.h"
#include "calib/present/pictures/map_picture.h"
#include "services/foxglove/stream/foxglove_stream.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/mapper_node.h"
#include "services/nodes/monitor_node.h"
#include "services/nodes/odometry_node.h"
#include "tests/fuzz/feed_node.h"
#include "tests/fuzz/small_session.h"

namespace rgbdt {
namespace {

// Hands on what it gets as Foxglove's messages, all of them made.
class FoxgloveNode : public Node {
 public:
  std::string name() const override { return "foxglove"; }
  std::vector<std::string> Subscriptions() const override { return {}; }
  Messages Handle(const Message& message) override {
    stream_.Take(message);
    return {};
  }
  Messages Advance(Utime /*now*/) override {
    stream_.Finish();
    return {};
  }
  Status GetStatus() const override { return {}; }

 private:
  FoxgloveStream stream_{{}, [](const FoxgloveMessage& message) { message.serialize(); }};
};

// As rgbdt-mapper, and as `rgbdt map` draws it.
class DrawnMapper : public MapperNode {
 public:
  DrawnMapper() : MapperNode(Options()) {}
  Messages Handle(const Message& message) override {
    Messages said = MapperNode::Handle(message);
    const auto* cloud = std::get_if<RgbdtCloud>(&message);
    if (cloud != nullptr && cloud->map_from_lidar) {
      way_.push_back(cloud->map_from_lidar->translation);
    }
    return said;
  }
  Messages Advance(Utime /*now*/) override {
    if (map().size() > 0) MapPicture(map().Cloud(), way_, way_, 100);
    return {};
  }

 private:
  static VoxelMapOptions Options() {
    VoxelMapOptions options;
    options.max_voxels = 1000;
    return options;
  }
  std::vector<Eigen::Vector3d> way_;
};

std::unique_ptr<Node> NodeOf(unsigned kind) {
  switch (kind % 6) {
    case 0:
      return std::make_unique<AssemblerNode>();
    case 1:
      return std::make_unique<FuserNode>();
    case 2:
      return std::make_unique<DrawnMapper>();
    case 3:
      return std::make_unique<MonitorNode>();
    case 4:
      return std::make_unique<OdometryNode>();
    default:
      return std::make_unique<FoxgloveNode>();
  }
}

RigText RigOf(unsigned kind) {
  const Rig rig = ParseRig(kind % 2 == 0 ? fuzz::kSmallRig : fuzz::kTurnedRig, "rig.textproto");
  return {0, rig.hash, rig.text};
}

void TakeInput(fuzz::Input input) {
  const unsigned kind = input.Byte();
  const std::unique_ptr<Node> node = NodeOf(kind);
  fuzz::Try([&] { node->Handle(RigOf(kind / 6)); });
  fuzz::Feed(&input, node.get());
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput({data, size});
  return 0;
}
