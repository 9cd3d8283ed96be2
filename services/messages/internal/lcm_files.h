#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rgbdt {

/// One field of a message type: `float x_m[num_points][3];`
struct LcmField {
  std::string type;  ///< "float", or the name of another message type
  std::string name;
  std::vector<std::string> sizes;  ///< of an array: "3", or the name of the field that counts
};

struct LcmType {
  std::string name;
  std::vector<LcmField> fields;
};

/// The types of one or more .lcm files, one text after the other. Constants are passed over: they
/// take no bytes. Throws std::logic_error at what is not of the form that lcmtypes/ uses.
std::vector<LcmType> ParseLcm(std::string_view text);

/// The texts of lcmtypes/*.lcm, put into the library when it is built.
std::string_view LcmFiles();

}  // namespace rgbdt
