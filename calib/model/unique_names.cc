#include "calib/model/unique_names.h"

namespace rgbdt {

std::string UniqueNames::Make(const std::string& wanted) {
  if (Insert(wanted)) return wanted;
  int& number = last_.emplace(wanted, 1).first->second;
  std::string name;
  do {
    name = wanted + "_" + std::to_string(++number);
  } while (!Insert(name));
  return name;
}

}  // namespace rgbdt
