#include "calib/model/method.h"

#include "calib/model/errors.h"

namespace rgbdt {

void RequireMethod(const std::string& method) {
  if (method == kAutoMethod || method == kPlaneMethod || method == kPaperMethod) return;
  throw InputError("unknown method \"" + method + "\"; there are: auto, plane, paper");
}

}  // namespace rgbdt
