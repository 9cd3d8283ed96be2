#include "calib/methods/board_check.h"

#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

CheckerboardResult FindInAny(const CameraSpec& camera, const Target& target,
                             const std::vector<Image>& images) {
  CheckerboardResult result;
  for (const Image& image : images) {
    CheckImage(camera, image);
    result = FindCheckerboard(ToGrey(image), target, SaturatedFrom(image));
    if (result.board) break;
  }
  return result;
}

}  // namespace

BoardCheck CheckBoard(const CameraSpec& camera, const Target& target,
                      const std::vector<Image>& images) {
  BoardCheck check;
  const CheckerboardResult stated = FindInAny(camera, target, images);
  check.found = stated.board.has_value();
  check.why = stated.why;
  if (target.markers) return check;  // says itself what is seen instead
  for (const int more : {1, -1}) {
    if (check.found || check.instead) break;
    Target other = target;
    other.squares_x += more;
    other.squares_y += more;
    if (other.squares_x < 4 || other.squares_y < 4) continue;
    if (FindInAny(camera, other, images).board) check.instead = other;
  }
  return check;
}

std::string OtherBoard(const Target& stated, const BoardCheck& check) {
  const Target& seen = *check.instead;
  return Format(
      "the images show %d x %d squares (%d x %d inner corners), not %d x %d: count squares, "
      "not inner corners",
      seen.squares_x, seen.squares_y, seen.corners_x(), seen.corners_y(), stated.squares_x,
      stated.squares_y);
}

}  // namespace rgbdt
