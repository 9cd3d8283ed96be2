#pragma once

#include <exception>
#include <functional>
#include <iostream>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rgbdt::study {

/// The main of a study: what it is called with after its name, and how it is called.
struct Study {
  std::string name;
  std::string usage;  ///< its arguments: "COUNT SEED CSV"
  std::size_t least = 0, most = 0;
  std::function<void(const std::vector<std::string>& arguments)> run;
};

/// On one core, as times are told of one. Returns 2 for a wrong number of arguments, 1 where the
/// study throws.
inline int StudyMain(const Study& study, int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() < study.least || arguments.size() > study.most) {
    std::cerr << "Usage: " << study.name << " " << study.usage << "\n";
    return 2;
  }
  try {
    cv::setNumThreads(1);
    study.run(arguments);
  } catch (const std::exception& error) {
    std::cerr << study.name << ": " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace rgbdt::study
