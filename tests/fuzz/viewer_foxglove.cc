// What a client of Foxglove's protocol says in a WebSocket's frame.
#include "tests/fuzz/fuzz.h"
#include "viewer/server/internal/foxglove_protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  const std::string text = fuzz::Input(data, size).Rest();
  fuzz::Try([&] {
    const viewer::FoxgloveRequest request = viewer::ParseFoxgloveRequest(text);
    fuzz::Require(request.op.size() <= 200, "an op of a bounded length");
    viewer::WarningText(request.op);  // it is sent back
  });
  return 0;
}
