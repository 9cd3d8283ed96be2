// A log of lcm-logger.
#include "services/bus/log.h"

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("session.lcmlog");
  file.Write(fuzz::Input(data, size).Rest());
  fuzz::Try([&] {
    constexpr std::size_t kHeader = 28;
    LogReader log(file.path());
    std::size_t seen = 0;
    while (const auto event = log.Next()) {
      seen += kHeader + event->channel.size() + event->bytes.size();
    }
    seen += static_cast<std::size_t>(log.unreadable_bytes());
    fuzz::Require(seen == size, "each byte in an event or unreadable, once");
  });
  return 0;
}
