#pragma once

#include <map>
#include <set>
#include <string>

namespace rgbdt {

/// Names of views by their clouds' file names: what can be a folder's name, each another one.
class ViewNames {
 public:
  /// Of the file's name without its ending: its first 90 bytes, spaces as `_`; "a_2" where "a" is
  /// taken. Takes as long however many are alike.
  std::string NameOf(const std::string& file);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> next_;  // number to try, by name
};

}  // namespace rgbdt
