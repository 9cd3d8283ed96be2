#include "services/drivers/hokuyo/scip_protocol.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/unit/packets/livox_encoder.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;

void AddScip(Inputs* seeds) {
  // Without sums, which the target adds; pieces of 1 + 16 * 4 bytes.
  const std::string mended = "\x01\x04";
  const std::string parameters =
      "PP\n00\nMODL:URG-04LX(Hokuyo);\nDMIN:20;\nDMAX:5600;\nARES:1024;\nAMIN:44;\nAMAX:725;\n"
      "AFRT:384;\nSCAN:600;\n\n";
  const std::string distances = "MD0002000401000\n99\nm2@0\n0Cb00100m\n\n";
  (*seeds)["parameters"] = mended + parameters;
  (*seeds)["time"] = mended + "TM1\n00\nm2@0\n\n";
  (*seeds)["distances"] = mended + distances;
  (*seeds)["intensities"] = mended + "ME0002000401000\n99\nm2@0\n0Cb00100m0Cb00100m\n\n";
  (*seeds)["stream"] = mended + "SCIP2.0\n0\n\n" + parameters + distances + distances;
  (*seeds)["rubbish"] = mended + "\r\n\n\nxx\n\n" + distances;
  for (const char* reply :
       {"TM0\n01", "TM0\n02", "TM2\n03", "TM1\n04", "BM\n01", "BM\n02", "MD\n03", "MD\n30",
        "ME\n55", "MS\n98", "RS\n0A", "RS\n0B", "RS\n0C", "RS\n0D", "RS\n0E", "RS\n10", "QT\n77"}) {
    std::string name = reply;
    name[name.find('\n')] = '_';
    (*seeds)[name] = mended + reply + "\n\n";
  }
  std::string raw(2, '\0');
  raw[1] = '\x01';
  (*seeds)["raw"] = raw + "PP\n00P\nDMIN:20;4\n\nMD0002000401000\n99c\nm2@0W\n\n";
  (*seeds)["endless"] = raw + std::string(2000, 'x');
}

// A word of the time since the one before [64 us], and the packet.
std::string Packets(const VelodyneEncoder& encoder, int first, int last) {
  std::string bytes;
  for (int number = first; number < last; ++number) {
    const std::vector<std::uint8_t> packet = encoder.Packet(number);
    bytes += std::string("\0\x10", 2) + std::string(packet.begin(), packet.end());
  }
  return bytes;
}

void AddVelodyne(Inputs* seeds) {
  using Model = VelodyneEncoder::Model;
  char kind = 0;
  for (const Model model : {Model::kVlp16, Model::kVlp32c, Model::kHdl32e, Model::kHdl64e}) {
    const std::string name = "model" + std::to_string(kind);
    VelodyneEncoder encoder = MadeUpVelodyne(model);
    (*seeds)[name] = std::string(1, kind) + Packets(encoder, 0, 2);
    // So fast that a revolution takes few packets.
    encoder.block_turn = 2900;
    (*seeds)[name + "_turns"] = std::string(1, kind) + Packets(encoder, 0, 5);
    (*seeds)[name + "_gap"] =
        std::string(1, kind) + Packets(encoder, 0, 2) + Packets(encoder, 4, 6);
    (*seeds)[name + "_again"] =
        std::string(1, kind) + Packets(encoder, 3, 4) + Packets(encoder, 1, 2);
    encoder.dual = true;
    (*seeds)[name + "_dual"] = std::string(1, kind) + Packets(encoder, 0, 2);
    (*seeds)[name + "_mended"] = static_cast<char>(kind | 4) + Packets(encoder, 0, 1);
    ++kind;
  }
  (*seeds)["cut"] = (*seeds)["model0"].substr(0, 800);
}

// Packets of one point that say that they took 6.5 ms each, every 8 ms: few make a second.
std::string LivoxSeconds(std::uint8_t time_type, std::int64_t first_ns) {
  using Encoder = test::LivoxEncoder;
  std::string bytes(1, '\0');
  for (int number = 0; number < 250; ++number) {
    std::vector<std::uint8_t> packet = {0};
    for (const int head : {44, 0xffff, 1, number}) Encoder::Add(head, 2, &packet);
    packet.insert(packet.end(), {0, 2, time_type});
    packet.resize(28);
    Encoder::Add(first_ns + 8'000'000 * std::int64_t{number}, 8, &packet);
    for (const int centimetres : {300, 50, -20}) Encoder::Add(centimetres, 2, &packet);
    packet.insert(packet.end(), {90, 0});  // reflectivity, tag
    bytes += std::string("\0\x7d", 2) + Piece({packet.begin(), packet.end()});
  }
  return bytes;
}

// A word of the time since the one before [64 us], and the packet as a piece.
void AddLivox(Inputs* seeds) {
  for (const bool sdk1 : {false, true}) {
    for (int type = 0; type < 9; ++type) {
      if (type == 6 || (sdk1 ? type < 2 : type < 1 || type > 3)) continue;
      const test::LivoxEncoder encoder{sdk1, type};
      std::string bytes(1, sdk1 ? '\1' : '\0');
      for (const int number : {0, 1, 900, 1000, 2100}) {
        const std::vector<std::uint8_t> packet = encoder.Packet(number);
        bytes += std::string("\0\x10", 2) + Piece({packet.begin(), packet.end()});
      }
      const std::string name = (sdk1 ? "sdk1_" : "sdk2_") + std::to_string(type);
      (*seeds)[name] = bytes;
      bytes[0] = static_cast<char>(bytes[0] | 2);
      (*seeds)[name + "_mended"] = bytes;
    }
  }
  constexpr std::int64_t kFirst = 1'700'000'000'000'000'000, kTai = 37'000'000'000;
  (*seeds)["since_start"] = LivoxSeconds(0, 5'000'000'000);
  (*seeds)["ptp"] = LivoxSeconds(1, kFirst + kTai);
  (*seeds)["gps"] = LivoxSeconds(2, kFirst);
  // Year, month, day, hour, microseconds.
  constexpr std::int64_t kDate = 23 | 11 << 8 | 14 << 16 | 22 << 24 | std::int64_t{5000} << 32;
  const auto dated = test::LivoxEncoder{true, 2, 3, kDate}.Packet(0);
  (*seeds)["dated"] = "\1" + std::string("\0\x10", 2) + Piece({dated.begin(), dated.end()});
}

void AddPcap(Inputs* seeds) {
  using Link = PcapWriter::Link;
  for (const bool next_generation : {false, true}) {
    for (const Link link : {Link::kEthernet, Link::kVlan, Link::kCooked, Link::kRaw}) {
      PcapWriter writer;
      writer.link = link;
      writer.next_generation = next_generation;
      writer.Begin();
      writer.Add(test::kNow, {1, 2, 3});
      writer.Add(test::kNow + 1, std::vector<std::uint8_t>(100, 7), 60);
      (*seeds)[(next_generation ? "ng" : "pcap") + std::to_string(static_cast<int>(link))] =
          writer.bytes;
    }
  }
}

void AddDynamixel(Inputs* seeds) {
  // Servo, length, error and parameters.
  (*seeds)["pong"] = std::string("\x01\x04\x00\x06\x04\x26", 6);
  (*seeds)["read"] = std::string("\x01\x05\x00\xa6\x00\x00\x00", 7) +
                     std::string("\x02\x02\x80\x04", 4) + std::string("\x02\x03\x00\x04\x01", 5);
  for (char error = 0; error < 9; ++error) {
    (*seeds)["error" + std::to_string(error)] = std::string("\x01\x02", 2) + error + '\x7f';
  }
  (*seeds)["stuffed"] = std::string("\x03\x09\x00\xff\xff\xfd\xfd\x00\x01\xff\xfd", 11);
  (*seeds)["rubbish"] = std::string("\x80\x06\xff\xff\x00\xff\xff\xfd", 8) +
                        std::string("\x01\x04\x00\x06\x04\x26", 6);
  (*seeds)["long"] = std::string("\x80\x08\xff\xff\xfd\x00\x01\xff\xff\x55", 10) +
                     std::string("\x01\x04\x00\x06\x04\x26", 6);
  (*seeds)["echo"] =
      std::string("\x41\x04\xff\xff\xfd\x00", 6) + std::string("\x01\x04\x00\x06\x04\x26", 6);
  (*seeds)["wrong_sum"] = std::string("\x80\x0b\xff\xff\xfd\x00\x01\x04\x00\x55\x00\x12\x34", 13);
  (*seeds)["cleared"] = std::string("\xff\x05\xff\xff\xfd\x00\x01", 7);
}

void AddCamera(Inputs* seeds) {
  for (char format = 0; format < 14; ++format) {
    (*seeds)["format" + std::to_string(format)] =
        std::string{format, 0, 4, 0, 2} + std::string(24, static_cast<char>(0x5a));
  }
  std::string discovery(8 + 248, '\0');
  discovery.replace(0, 8, std::string("\0\0\0\x03\0\xf8\x12\x34", 8));
  discovery.replace(8 + 72, 4, "Acme");
  discovery.replace(8 + 104, 12, "Fieldcam\x1b[2J");
  (*seeds)["no_serial"] = '\x21' + discovery;
  discovery.replace(8 + 216, 16, "0123456789abcdef");
  (*seeds)["discovery"] = '\x21' + discovery;
  (*seeds)["register"] = '\x21' + std::string("\0\0\0\x81\0\x04\x12\x34\0\0\0\x02", 12);
  (*seeds)["denied"] = '\x21' + std::string("\x80\x06\0\x81\0\x04\x12\x34\0\0\0\0", 12);
  (*seeds)["other"] = '\x20' + std::string("\0\0\0\x81\0\x04\x12\x35\0\0\0\x02", 12);
}

}  // namespace

void AddDeviceSeeds(Seeds* seeds) {
  AddScip(&(*seeds)["scip"]);
  AddVelodyne(&(*seeds)["velodyne"]);
  AddLivox(&(*seeds)["livox"]);
  AddPcap(&(*seeds)["pcap_file"]);
  AddDynamixel(&(*seeds)["dynamixel"]);
  AddCamera(&(*seeds)["camera"]);
}

}  // namespace rgbdt::fuzz
