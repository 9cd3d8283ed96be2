// A bag that `rgbdt import` makes something of. The first byte says what: a log of its clouds, one
// with the images of a rig's camera, or a session.
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "services/bus/log.h"
#include "services/import/import_log.h"
#include "services/messages/codec.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

enum Makes : unsigned { kLog, kLogOfRig, kSession, kMakes };

constexpr const char* kRig = R"(name: "small"
lidar { name: "lidar" }
camera { name: "rgb" kind: COLOR width: 4 height: 2 pixel_format: BGR8 pinhole { fx: 4 fy: 4 cx: 2 cy: 1 } }
target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 1 height_m: 0.8 }
)";

std::optional<LogRig> RigOf(unsigned makes) {
  if (makes != kLogOfRig) return std::nullopt;
  return LogRig{ParseRig(kRig, "rig.textproto"), std::nullopt};
}

void CheckLog(const fs::path& path, const WrittenLog& written) {
  LogReader log(path);
  std::int64_t images = 0;
  Utime before = std::numeric_limits<Utime>::min();
  while (const auto event = log.Next()) {
    fuzz::Require(event->receive_utime >= before, "messages in the order of time");
    before = event->receive_utime;
    const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
    images += std::holds_alternative<Image>(message) ? 1 : 0;
  }
  fuzz::Require(log.unreadable_bytes() == 0 && images == written.images, "a log of what was told");
}

void MakeLog(BagReader* bag, const TopicChoice& choice, unsigned makes, const fs::path& path) {
  const auto written = WriteLog(bag, choice, RigOf(makes), CloudMessages(bag, *choice.lidar.clouds),
                                path, [](double share) { fuzz::Require(share <= 1, "a share"); });
  try {
    CheckLog(path, written);
  } catch (const InputError& error) {
    fuzz::Require(false, std::string("a log that is read; ") + error.what());
  }
}

void MakeSession(BagReader* bag, const BagSurvey& survey, const TopicChoice& choice,
                 const fs::path& dir) {
  constexpr std::size_t kMost = 4;
  RigWishes wishes;
  wishes.board = ParseRig(kRig, "rig.textproto").target;
  wishes.model = Lens::Model::kPinhole;
  const BagRig rig = ReadRig(bag, survey, choice, wishes);
  std::vector<Utime> times = EverySeconds(choice, 1);
  times.resize(std::min(kMost, times.size()));
  std::vector<std::string> left_over;
  const auto moments = PairAt(choice, times, 1, &left_over);
  std::vector<CloudReader> read_clouds = {CloudMessages(bag, *choice.lidar.clouds)};
  for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
    read_clouds.push_back(CloudMessages(bag, *lidar.clouds));
  }
  WriteMoments(bag, choice, rig.rig, moments, read_clouds, dir, {}, &left_over);
  try {
    const Session session = OpenSession(dir, LensNeed::kMayBeUnknown);
    for (const std::string& view : session.views) ReadView(session, view);
  } catch (const InputError& error) {
    fuzz::Require(false, std::string("a session that is read; ") + error.what());
  }
}

void TakeInput(fuzz::Input input) {
  static const fuzz::ScratchFile file("bag.mcap");
  const fs::path out = file.folder() / "out";
  const unsigned makes = input.Byte() % kMakes;
  file.Write(input.Rest());
  fuzz::Try([&] {
    const auto bag = OpenBag(file.path());
    const BagSurvey survey = SurveyBag(bag.get(), {});
    TopicWishes wishes;
    wishes.clouds_alone = makes == kLog;
    wishes.one_lidar = makes != kSession;
    const TopicChoice choice = ChooseTopics(survey, wishes);
    if (choice.lidar.clouds->data == BagData::kPackets) return;  // bag_packets reads them
    if (makes == kSession) {
      MakeSession(bag.get(), survey, choice, out);
    } else {
      MakeLog(bag.get(), choice, makes, out);
    }
  });
  fs::remove_all(out);
  for (const fs::directory_entry& left : fs::directory_iterator(file.folder())) {
    fuzz::Require(left.path() == file.path(), "nothing left; there is " + left.path().string());
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput({data, size});
  return 0;
}
