#include "calib/model/version.h"

namespace rgbdt {

const char* Version() { return RGBDT_VERSION; }

}  // namespace rgbdt
