#pragma once

#include <map>
#include <set>
#include <string>

namespace rgbdt {

/// Names that are each there once. As quick for many that are alike as for others.
class UniqueNames {
 public:
  /// False where it is there already.
  bool Insert(const std::string& name) { return names_.insert(name).second; }

  /// Inserts `wanted`, or where that is there already the first of `wanted`_2, _3, ... that is not.
  std::string Make(const std::string& wanted);

 private:
  std::set<std::string> names_;
  std::map<std::string, int> last_;  // number that `Make` gave, by what was wanted
};

}  // namespace rgbdt
