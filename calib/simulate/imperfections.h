#pragma once

#include <string>

#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// Gives the rig what real ones are off by, drawn from options->seed. Call it when the options have
/// their LIDAR. The rig file states sigmas, and what is drawn keeps to them:
/// - each lens: 0.5% of the focal lengths, 0.6% of the image's width in the centre, 0.02 in k1;
/// - the pattern's print: 0.3% of its width and height;
/// - all ranges: a constant, sigma 20 mm.
/// It says nothing of, drawn evenly:
/// - ranges of dark surfaces: up to 20 mm longer than of bright ones;
/// - the beam: divergence of 1.5 to 4 mrad, the least return, and what still merges;
/// - a spinning LIDAR's rings: an offset each, sigma 3 to 10 mm; its beams meet at up to 45 mm.
void MakeImperfect(Options* options);

/// What these options are off by, a line each; empty: nothing.
std::string ImperfectionsText(const Options& options);

}  // namespace rgbdt::simulate
