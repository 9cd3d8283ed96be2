#pragma once

#include "calib/model/cloud.h"
#include "calib/simulate/simulator.h"

namespace rgbdt {

/// One sweep of the synthetic scanner from a time on, assembled as the assembler does on the bus.
Cloud TakeSweep(const simulate::Simulator& simulator, Utime sweep_utime);

}  // namespace rgbdt
