// What a browser says in a WebSocket's frame.
#include "tests/fuzz/fuzz.h"
#include "viewer/server/internal/message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  const std::string text = fuzz::Input(data, size).Rest();
  fuzz::Try([&] {
    const auto message = viewer::ParseMessage(text);
    fuzz::Require(viewer::ParseMessage(message.dump()) == message, "the same message once more");
  });
  return 0;
}
