// What the viewer makes of messages that anybody may send, well-formed ones (feed_node.h): posts
// for browsers, all of them made. The first byte: whether it has heard the rig.
#include "calib/files/schema/rig_file.h"
#include "tests/fuzz/feed_node.h"
#include "tests/fuzz/small_session.h"
#include "viewer/live/live_node.h"

namespace rgbdt {
namespace {

class MadePosts : public viewer::Outbox {
 public:
  void Send(viewer::Post post) override {
    fuzz::Try([&] { fuzz::Require(!post.make().empty(), "a frame"); });
  }
  void Forget(const std::string& /*topic_prefix*/) override {}
};

void TakeInput(fuzz::Input input) {
  MadePosts posts;
  viewer::LiveNode node;
  node.PostTo(&posts);
  if (input.Byte() % 2 == 0) {
    const Rig rig = ParseRig(fuzz::kSmallRig, "rig.textproto");
    fuzz::Try([&] { node.Handle(RigText{0, rig.hash, rig.text}); });
  }
  fuzz::Feed(&input, &node);
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput({data, size});
  return 0;
}
