// A rig file, as it lies on disk and as it comes over the bus; which programs `rgbdt up` makes of
// it.
#include "calib/files/schema/rig_file.h"
#include "services/up/rig_programs.h"
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
  fuzz::Try([&] {
    const Rig rig = ParseRig(text, "rig.textproto");
    const std::vector<Program> all = ProgramsOf(rig, {});
    const std::string host = rig.hosts.empty() ? "a" : rig.hosts.front().name;
    fuzz::Require(ProgramsOn(host, rig, all).size() <= all.size(), "none that the rig has not");
  });
  return 0;
}
