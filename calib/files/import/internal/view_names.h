#pragma once

#include <string>

#include "calib/model/unique_names.h"

namespace rgbdt {

/// Names of views by their clouds' file names: what can be a folder's name, each another one.
class ViewNames {
 public:
  /// Of the file's name without its ending: its first 90 bytes, spaces as `_`; "a_2" where "a" is
  /// taken.
  std::string NameOf(const std::string& file);

 private:
  UniqueNames names_;
};

}  // namespace rgbdt
