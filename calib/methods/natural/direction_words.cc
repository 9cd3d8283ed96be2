#include "calib/methods/natural/direction_words.h"

#include <array>

namespace rgbdt {
namespace {

struct Words {
  const char* direction;
  const char* needed;
};
constexpr std::array<Words, 6> kWords = {{
    {"a turn about the camera's x (pitch)", "horizontal edges"},
    {"a turn about the camera's y (yaw)", "vertical edges"},
    {"a turn about the camera's z (roll)", "edges near the image's left and right border"},
    {"a move along the camera's x (right)", "vertical edges close by"},
    {"a move along the camera's y (down)", "horizontal edges close by"},
    {"a move along the camera's z (forward)", "edges close by, near the image's border"},
}};

}  // namespace

Eigen::Index MainNumber(const Vector6d& delta, const Vector6d& sigma) {
  Eigen::Index most = 0;
  delta.cwiseQuotient(sigma).cwiseAbs().maxCoeff(&most);
  return most;
}

std::string DirectionWords(Eigen::Index number) {
  return kWords.at(static_cast<std::size_t>(number)).direction;
}

std::string NeededFor(Eigen::Index number) {
  return kWords.at(static_cast<std::size_t>(number)).needed;
}

}  // namespace rgbdt
