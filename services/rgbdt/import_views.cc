#include "services/rgbdt/import_views.h"

#include <algorithm>
#include <cstdio>

#include "calib/files/import/board_text.h"
#include "calib/methods/board_check.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/import/still.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

// Seconds since the bag's start, or since 1970.
std::vector<Utime> TimesOf(const std::vector<std::string>& texts, Utime start) {
  constexpr double kSince1970 = 1e8;
  std::vector<Utime> times;
  for (const std::string& text : texts) {
    std::size_t read = 0;
    double seconds = -1;
    try {
      seconds = std::stod(text, &read);
    } catch (const std::exception&) {
      read = 0;
    }
    if (read == 0 || read != text.size() || !(seconds >= 0 && seconds < 1e11)) {
      throw UsageError("--at is \"" + text + "\"; expected seconds since the bag's start, or 1970");
    }
    times.push_back(FromSeconds(seconds) + (seconds < kSince1970 ? start : 0));
  }
  return times;
}

std::size_t ReferenceCamera(const Rig& rig) {
  const auto colour =
      std::find_if(rig.cameras.begin(), rig.cameras.end(),
                   [](const CameraSpec& camera) { return camera.kind == CameraKind::kColor; });
  return colour == rig.cameras.end() ? 0 : static_cast<std::size_t>(colour - rig.cameras.begin());
}

// Counts that are of inner corners are told; why else the board is in none of some images.
std::string WhyNotSeen(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                       const std::vector<Stamped>& stamped) {
  constexpr std::size_t kImages = 3;
  const std::size_t camera = ReferenceCamera(rig);
  std::vector<Image> images;
  for (std::size_t i = 0; i < std::min(kImages, stamped.size()); ++i) {
    const std::size_t at = (2 * i + 1) * stamped.size() / (2 * std::min(kImages, stamped.size()));
    try {
      images.push_back(ReadImage(bag, choice.cameras[camera], rig.cameras[camera], stamped[at]));
    } catch (const InputError&) {  // told where it is to be written
    }
  }
  const BoardCheck check = CheckBoard(rig.cameras[camera], rig.target, images);
  if (check.instead) {
    throw InputError("--board: " + rig.cameras[camera].name + ": " + OtherBoard(rig.target, check));
  }
  return check.found ? "" : check.why;
}

// When the board stands still.
std::vector<Utime> StillTimes(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                              const ImportFlags& flags) {
  if (!rig.target.HasPattern()) {
    throw InputError("a plain board is not looked for in the images: say --every or --at");
  }
  const std::size_t camera = ReferenceCamera(rig);
  const std::string& name = rig.cameras[camera].name;
  const StillMoments still = FindStillMoments(bag, choice.cameras[camera], rig.cameras[camera],
                                              rig.target, static_cast<std::size_t>(flags.views),
                                              Tenths("looking for the board in " + name));
  if (still.found == 0) {
    const std::string why = WhyNotSeen(bag, choice, rig, choice.cameras[camera].images->stamped);
    throw InputError("the board is in none of " + std::to_string(still.looks) + " images of " +
                     name + (why.empty() ? "" : ": " + why) +
                     "; --every or --at takes views anyway");
  }
  std::printf("board found in %zu of %zu images of %s; it stood still %zu times, %zu are taken\n",
              still.found, still.looks, name.c_str(), still.stands, still.times.size());
  if (still.times.empty()) {
    throw InputError("the board never stood still for a second (less than " +
                     Fixed(kStillForSecondPx, 1) + " px in " + name +
                     "); --every or --at takes views anyway");
  }
  return still.times;
}

}  // namespace

RigWishes RigWishesOf(const ImportFlags& flags) {
  RigWishes wishes;
  wishes.board = ParseBoard(flags.board);
  for (const std::string& text : flags.lenses) wishes.lenses.push_back(LensFileOf(text));
  if (flags.pinhole) wishes.model = Lens::Model::kPinhole;
  if (flags.fisheye) wishes.model = Lens::Model::kFisheye;
  return wishes;
}

std::vector<std::string> WithoutLens(const Rig& rig) {
  std::vector<std::string> names;
  for (const CameraSpec& camera : rig.cameras) {
    if (!camera.lens.known()) names.push_back(camera.name);
  }
  return names;
}

std::vector<Moment> MomentsOf(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                              const ImportFlags& flags, std::vector<std::string>* left_over) {
  const bool told = flags.every_s > 0 || !flags.at.empty();
  const std::vector<Utime> times = !flags.at.empty()   ? TimesOf(flags.at, StartOf(choice))
                                   : flags.every_s > 0 ? EverySeconds(choice, flags.every_s)
                                                       : StillTimes(bag, choice, rig, flags);
  std::vector<Moment> moments = PairAt(choice, times, flags.max_apart_s, left_over);
  if (!told || !rig.target.HasPattern()) return moments;
  std::vector<Stamped> images;
  for (const Moment& moment : moments) {
    const auto& image = moment.images[ReferenceCamera(rig)];
    if (image) images.push_back(*image);
  }
  const std::string why = images.empty() ? "" : WhyNotSeen(bag, choice, rig, images);
  if (!why.empty()) {
    std::printf("warning: the board is in none of the images of %s looked at: %s\n",
                rig.cameras[ReferenceCamera(rig)].name.c_str(), why.c_str());
  }
  return moments;
}

}  // namespace rgbdt
