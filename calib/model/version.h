#pragma once

namespace rgbdt {

/// Of this build, e.g. "0.1.0".
const char* Version();

}  // namespace rgbdt
