#include <vector>

#include "services/bus/bus_key.h"
#include "services/bus/internal/repair_message.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"
#include "services/messages/signature.h"
#include "tests/datagrams.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt::fuzz {
namespace {

std::string AsText(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

// One byte for the channel (its place in OneOfEach), then what follows the fingerprint.
std::string MessageSeed(std::size_t place, const Message& message) {
  return static_cast<char>(place) + AsText(Encode(message)).substr(8);
}

// Every nested struct, in few bytes.
ViewDetection WholeDetection(testing::RandomMessages* random) {
  ViewDetection detection = random->Seen();
  ImageDetection image = random->InImage();
  image.why_not = "";
  image.edges = ImageEdges{};
  image.edges->width = image.edges->height = 100;
  image.edges->outline_corners.fill({1, 2});
  image.edges->corners = {{3, 4}, {5, 6}};
  image.edges->outline = {{3, 4}, {5, 6}};
  image.edges->edge_pixels = {{3, 4}, {5, 6}};
  ImageSide side = random->Side();
  side.curve.resize(2, {3, 4});
  image.edges->pose = random->PoseOfTarget();
  image.edges->sides.fill(side);
  detection.images = {image};
  CloudEdges board = random->Boundary();
  board.boundary.resize(1);
  board.pose = random->PoseOfTarget();
  board.crossings.assign(2, random->WhereAScanLeaves());
  board.groups.assign(1, random->Group());
  detection.cloud.candidates.assign(2, board);
  detection.cloud.why_not = "";
  return detection;
}

void AddMessages(std::map<std::string, std::string>* seeds) {
  constexpr std::size_t kMost = 6000;  // a small one is mutated more often
  for (std::uint64_t round = 0; round < 12; ++round) {
    testing::RandomMessages random(round + 1);
    const Messages messages = random.OneOfEach();
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const std::string seed = MessageSeed(i, messages[i]);
      // Three of each, and more of those that have many parts.
      const bool rich = std::holds_alternative<ViewDetection>(messages[i]) ||
                        std::holds_alternative<Image>(messages[i]) ||
                        std::holds_alternative<CalibrationMessage>(messages[i]);
      if (seed.size() > kMost || (round >= 3 && !rich)) continue;
      (*seeds)[ChannelOf(messages[i]) + std::to_string(round)] = seed;
    }
  }
  testing::RandomMessages random(1);
  const Messages messages = random.OneOfEach();
  for (const PixelFormat format : {PixelFormat::kPng, PixelFormat::kJpeg}) {
    Image image = random.Picture(PixelFormat::kBgr8);
    image.format = format;
    (*seeds)[format == PixelFormat::kPng ? "png" : "jpeg"] = MessageSeed(2, image);
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (!std::holds_alternative<ViewDetection>(messages[i])) continue;
    Bytes whole = Encode(messages[i]);
    AppendSignature({1, 2, 3, {4, 5}}, &whole);
    (*seeds)["signed"] = static_cast<char>(i) + AsText(whole).substr(8);
    (*seeds)["detection_whole"] = MessageSeed(i, WholeDetection(&random));
  }
  RgbdtCloud sweep = random.Fused();
  sweep.whole_sweep = true;
  (*seeds)["sweep"] = MessageSeed(messages.size(), sweep);
}

// As datagrams.cc takes one: kind and sender, and the bytes without their magic.
std::string DatagramSeed(const Bytes& bytes) {
  const std::string text = AsText(bytes);
  if (text.rfind("LC0", 0) != 0) return '\x81' + Piece(text);
  return (text[3] == '3' ? '\x41' : '\x01') + Piece(text.substr(4));
}

// On RGBDT_REPAIR, of one of 62 senders.
std::string RepairSeed(int sender, const Bytes& message) {
  const std::string channel(kRepairChannel, sizeof kRepairChannel);
  return static_cast<char>(sender) +
         Piece(AsText(test::ShortDatagram(0, channel, message)).substr(4));
}

void AddRepairs(std::map<std::string, std::string>* seeds) {
  const std::string name("CLOUD\0", 6);
  const auto beat = [](std::uint64_t id, std::uint32_t oldest, std::uint32_t next) {
    return RepairSeed(static_cast<int>(id), Encode(Beat{id, oldest, next, next, 1, "host"}));
  };
  const auto repair = [](Bytes datagram) {
    datagram.insert(datagram.begin(), kRepairMark);
    return RepairSeed(1, datagram);
  };
  const auto fragment = [&](std::uint32_t at) {
    return test::Fragment{2, 30, 10 * at, at, 3, at == 0 ? name : "", Bytes(10, 'a')}.Datagram();
  };
  (*seeds)["repaired"] = beat(1, 0, 0) + DatagramSeed(test::ShortDatagram(1, name, {1})) +
                         DatagramSeed(fragment(0)) + DatagramSeed(fragment(2)) + beat(1, 0, 3) +
                         RepairSeed(2, Encode(RepairRequest{1, {{0, {}}, {2, {1}}}})) +
                         repair(test::ShortDatagram(0, name, {0})) + repair(fragment(1));
  const auto another = RepairSeed(1, Encode(Beat{2, 0, 0, 0, 1, "on the same port"}));
  (*seeds)["given_up"] =
      beat(1, 0, 0) + beat(1, 0, 5) + beat(1, 3, 5) + beat(1, 9000, 9000) + another;
  (*seeds)["forgotten"] = beat(1, 0, 0) + beat(1, 0, 5) + '\x3f' + beat(2, 0, 0);
  std::string far;
  for (std::uint64_t id = 1; id <= 3; ++id) far += beat(id, 0, 0) + beat(id, 0, 4096);
  for (std::uint32_t seq = 0; seq < 22; ++seq) {
    far += DatagramSeed(test::Fragment{seq, 3'000'000, 0, 0, 2, name, {1}}.Datagram());
  }
  (*seeds)["far_ahead"] = far;
  std::string lost;
  for (std::uint64_t id = 1; id <= 3; ++id) {
    lost += beat(id, 0, 0);
    lost += RepairSeed(static_cast<int>(id), Encode(Beat{id, 0, 0, std::uint64_t{1} << 62, 1, ""}));
  }
  (*seeds)["lost_much"] = lost;
}

void AddDatagrams(std::map<std::string, std::string>* seeds) {
  std::size_t number = 0;
  for (const test::Attack& attack : test::Attacks("CLOUD")) {
    std::string seed;
    for (const Bytes& datagram : attack.datagrams) seed += DatagramSeed(datagram);
    (*seeds)["attack" + std::to_string(++number)] = seed;
  }
  const std::string name("CLOUD\0", 6);
  const auto fragment = [&](std::uint32_t begin, std::uint32_t at) {
    return DatagramSeed(
        test::Fragment{7, 30, begin, at, 3, at == 0 ? name : "", Bytes(10, 'a')}.Datagram());
  };
  (*seeds)["short"] = DatagramSeed(test::ShortDatagram(1, name, Bytes(20, 1)));
  (*seeds)["whole"] = fragment(0, 0) + fragment(10, 1) + fragment(20, 2);
  (*seeds)["turned"] = fragment(0, 0) + fragment(20, 2) + fragment(20, 2) + fragment(10, 1);
  AddRepairs(seeds);
}

void AddLogs(std::map<std::string, std::string>* seeds) {
  const std::string log = Written([](const std::filesystem::path& path) {
    LogWriter writer(path);
    for (const int size : {0, 5, 300}) {
      writer.Write("CLOUD", Bytes(static_cast<std::size_t>(size), 7), 1'700'000'000'000'000);
    }
    writer.Close();
  });
  (*seeds)["log"] = log;
  (*seeds)["cut"] = log.substr(0, log.size() - 50);
  (*seeds)["rubbish"] = log + std::string(3000, 'x') + log;
}

void AddKeyFiles(std::map<std::string, std::string>* seeds) {
  (*seeds)["key"] = Written([](const std::filesystem::path& path) { WriteNewBusKey(path); });
  (*seeds)["no_end"] = std::string(64, 'A');
  (*seeds)["long"] = std::string(64, '1') + "\n\n";
  (*seeds)["odd"] = std::string(63, 'f') + "\n";
}

// Each a byte for whose it is (signature.cc) and a piece.
void AddSignatures(std::map<std::string, std::string>* seeds) {
  const std::string own = '\1' + Piece("abc"), other = '\5' + Piece("");
  (*seeds)["own"] = own + other + own;
  (*seeds)["stranger"] = '\0' + Piece(std::string(64, 'x') + "RGBDTSG1") + own;
  (*seeds)["changed"] = '\2' + Piece("abc") + std::string("\0\7\1", 3) + own;
  Bytes stamp;
  AppendSignature({1, 2, 1'700'000'000'000'000, {}}, &stamp);
  std::string liars;
  for (const char at : {'\0', '\x7f', '\x80', '\xff'}) {
    std::string odd = AsText(stamp).substr(0, kStampBytes);
    for (const std::size_t field : {8, 16}) {  // number, time
      odd[field] = at;
      liars += '\3' + Piece("abc") + odd;
    }
  }
  (*seeds)["liars"] = liars;
}

}  // namespace

void AddBusSeeds(Seeds* seeds) {
  AddMessages(&(*seeds)["message"]);
  AddDatagrams(&(*seeds)["datagrams"]);
  AddLogs(&(*seeds)["log"]);
  AddKeyFiles(&(*seeds)["key_file"]);
  AddSignatures(&(*seeds)["signature"]);
}

}  // namespace rgbdt::fuzz
