// Links rgbdt: colours the clouds of a calibrated session and makes messages of them. With
// librgbdt-dev installed, by CMake as CMakeLists.txt has it, or:
//   g++ -std=c++17 fuse_view.cc -o fuse_view $(pkg-config --cflags --libs rgbdt-messages)
//   ./fuse_view SESSION_DIR
#include <cmath>
#include <cstdio>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/files/session/session_dir.h"
#include "calib/fuse/fuse.h"
#include "services/messages/codec.h"

int main(int argc, char** argv) try {
  const rgbdt::Session session = rgbdt::OpenSession(argc > 1 ? argv[1] : ".");
  const rgbdt::Calibration calibration =
      rgbdt::ReadCalibration(session.root / "calibration.textproto");
  rgbdt::RequireSound(calibration, session.rig, {"calibration.textproto", "rig.textproto"},
                      rgbdt::Use::kIfSound);  // throws for one that is not to be used
  for (const std::string& name : session.views) {
    const rgbdt::View view = rgbdt::ReadView(session, name);
    const rgbdt::RgbdtCloud fused = rgbdt::FuseView(session.rig, calibration, view);
    std::size_t warm = 0;
    for (const float kelvin : fused.temperature_k) warm += std::isfinite(kelvin) ? 1 : 0;
    std::size_t bytes = 0;  // on RGBDT_CLOUD, in parts that the bus carries
    for (const rgbdt::RgbdtCloud& part : rgbdt::PartsOf(fused, 50000)) {
      bytes += rgbdt::Encode(part).size();
    }
    std::printf("%s: %zu points, %zu with a temperature, %zu bytes as messages\n", name.c_str(),
                fused.size(), warm, bytes);
  }
} catch (const std::exception& e) {
  std::fprintf(stderr, "fuse_view: %s\n", e.what());
  return 1;
}
