#include "calib/simulate/clocks.h"

#include "calib/model/text.h"
#include "calib/simulate/internal/dice.h"

namespace rgbdt::simulate {

std::vector<ClockOptions> DrawClocks(const Options& options) {
  std::vector<ClockOptions> clocks;
  for (const CameraOptions& camera : options.cameras) {
    Dice draw(options.seed, 0, "clock of " + camera.name);
    ClockOptions& clock = clocks.emplace_back();
    clock.offset_s = draw.Between(-0.1, 0.1);
    clock.drift = draw.Between(-2e-5, 2e-5);
    if (camera.kind == CameraKind::kColor) clock.rolling_s = draw.Between(0.010, 0.025);
  }
  return clocks;
}

std::string ClocksText(const Options& options, const std::vector<ClockOptions>& clocks) {
  std::string text;
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    text += options.cameras[i].name +
            Format(": time_offset_s %.6f, drifts by %.1f us/s, rolling_s %.6f\n",
                   clocks[i].offset_s, 1e6 * clocks[i].drift, clocks[i].rolling_s);
  }
  return text;
}

}  // namespace rgbdt::simulate
