// A recording of network packets.
#include "services/drivers/pcap/pcap_reader.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("recording.pcap");
  file.Write(fuzz::Input(data, size).Rest());
  fuzz::Try([&] {
    PcapReader reader(file.path());
    while (const auto datagram = reader.Next()) {
      fuzz::Require(datagram->payload.size() <= size, "no more than the file has");
    }
  });
  return 0;
}
