#pragma once

#include <string>

namespace rgbdt {

/// Whether a camera's name, folder or topic says that it is a thermal one. Of images of 16 bit (and
/// of temperatures) makers' and short names count, too (flir, boson, lepton, tau, ir): colour and
/// near infrared cameras of 8 bit are called so as well.
bool SaysThermal(const std::string& name, bool sixteen_bit);

}  // namespace rgbdt
