// A rig file, as it lies on disk and as it comes over the bus.
#include "calib/files/schema/rig_file.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  const std::string text = fuzz::Input(data, size).Rest();
  for (const LensNeed need : {LensNeed::kKnown, LensNeed::kMayBeUnknown}) {
    fuzz::Try([&] {
      const std::string printed = PrintRig(ParseRig(text, "rig.textproto", need));
      std::string again;
      try {
        again = PrintRig(ParseRig(printed, "printed", need));
      } catch (const InputError& error) {
        fuzz::Require(false, std::string("a printed rig that is read; ") + error.what());
      }
      fuzz::Require(printed == again, "the same rig printed again");
    });
  }
  return 0;
}
