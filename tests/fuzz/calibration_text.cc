// calibration.textproto, and truth.textproto, which holds likewise transforms.
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("calibration.textproto");
  file.Write(fuzz::Input(data, size).Rest());
  fuzz::Try([&] { ReadTruth(file.path()); });
  fuzz::Try([&] {
    const std::string printed = PrintCalibration(ReadCalibration(file.path()));
    file.Write(printed);
    std::string again;
    try {
      again = PrintCalibration(ReadCalibration(file.path()));
    } catch (const InputError& error) {
      fuzz::Require(false, std::string("a printed calibration that is read; ") + error.what());
    }
    fuzz::Require(printed == again, "the same calibration printed again");
  });
  return 0;
}
