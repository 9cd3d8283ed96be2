#include "calib/model/method.h"

#include <algorithm>

#include "calib/model/errors.h"

namespace rgbdt {

void RequireMethod(const std::string& method) {
  if (std::find(kMethodNames.begin(), kMethodNames.end(), method) != kMethodNames.end()) return;
  std::string names;
  for (const std::string& name : kMethodNames) names += (names.empty() ? "" : ", ") + name;
  throw InputError("unknown method \"" + method + "\"; there are: " + names);
}

}  // namespace rgbdt
