// A lens file of OpenCV, ROS or Kalibr. The first byte says which lens of it is wanted.
#include "calib/files/import/lens_file.h"

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  const unsigned wish = input.Byte();
  LensWanted wanted;
  wanted.file = "lens.yaml";
  wanted.camera = (wish & 1) != 0 ? "rgb" : "thermal";
  wanted.cameras = (wish & 2) != 0 ? 2 : 1;
  wanted.index = (wish & 6) == 6 ? 1 : 0;
  if ((wish & 8) != 0) wanted.entry = "cam1";
  if ((wish & 16) != 0) wanted.model = Lens::Model::kPinhole;
  if ((wish & 32) != 0) wanted.model = Lens::Model::kFisheye;
  const std::string text = input.Rest();
  fuzz::Try([&] { CheckLensSize(ParseLensFile(text, wanted), wanted.camera, 640, 480); });
  return 0;
}
