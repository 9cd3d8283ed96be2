#pragma once

#include "services/bus/log_writer.h"

namespace rgbdt::test {

using rgbdt::LogWriter;

}  // namespace rgbdt::test
