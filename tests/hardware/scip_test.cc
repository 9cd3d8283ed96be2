#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "calib/model/errors.h"
#include "services/drivers/hokuyo/scip_protocol.h"
#include "services/drivers/hokuyo/scip_scanner.h"
#include "tests/hardware/device_harness.h"
#include "tests/hardware/scip_peer.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

scip::Block BlockOf(const std::string& bytes) {
  scip::BlockReader reader;
  reader.Append(bytes);
  return reader.Take().value();
}

std::string WhatThrows(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing";
}

// As printed on the maker's pages (urgnetwork wiki, scip_status_en), sums included.
constexpr char kParametersReply[] =
    "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\n"
    "AMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";

// C-42-03320B, figures 6 and 7: 16 000 000 ms is m2@0.
TEST(ScipProtocol, DecodesTheSpecificationsExample) {
  EXPECT_EQ(scip::Decode("m2@0"), 16'000'000u);
  EXPECT_EQ(scip::Decode("0"), 0u);
  EXPECT_EQ(scip::Decode("oooo"), 0xffffffu);
  EXPECT_FALSE(scip::Decode("p"));
  EXPECT_FALSE(scip::Decode("/0"));
  EXPECT_FALSE(scip::Decode(""));
  EXPECT_FALSE(scip::Decode("00000"));
}

// The specification prints 00P and 99b as status with sum.
TEST(ScipProtocol, SumsOfTheSpecification) {
  EXPECT_EQ(scip::Checksum("00"), 'P');
  EXPECT_EQ(scip::Checksum("99"), 'b');
}

TEST(ScipProtocol, ParametersAsPrintedByTheMaker) {
  const scip::Parameters p = scip::ParseParameters(BlockOf(kParametersReply));
  EXPECT_EQ(p.model, "URG-04LX(Hokuyo Automatic Co.,Ltd.)");
  EXPECT_THAT((std::vector<int>{p.least_mm, p.most_mm, p.steps, p.first_step, p.last_step,
                                p.front_step, p.rpm}),
              ElementsAre(20, 5600, 1024, 44, 725, 384, 600));
  EXPECT_NEAR(p.first_angle_rad(), -340 * 2 * M_PI / 1024, 1e-12);
  EXPECT_NEAR(p.beam_period_s(), 0.1 / 1024, 1e-12);
}

TEST(ScipProtocol, BadParametersAreNamed) {
  const auto parse = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return WhatThrows([&] { scip::ParseParameters(BlockOf(text)); });
  };
  EXPECT_THAT(parse(kParametersReply, "AMAX:725;o", "AMAX:724;o"), HasSubstr("wrong checksum"));
  EXPECT_THAT(parse(kParametersReply, "AMAX:725;o", "AMAX:;"), HasSubstr("does not tell its AMAX"));
  EXPECT_THAT(
      parse(kParametersReply, "SCAN:600;e", std::string("SCAN:0;") + scip::Checksum("SCAN:0")),
      HasSubstr("SCAN is \"0\""));
  EXPECT_THAT(parse(kParametersReply, "00P", "0Ee"), HasSubstr("no such command"));
}

TEST(ScipProtocol, CommandsAreThoseOfTheSpecification) {
  EXPECT_EQ(scip::MeasureCommand(false, 44, 725), "MD0044072501000\n");
  EXPECT_EQ(scip::MeasureCommand(true, 0, 1080), "ME0000108001000\n");
}

TEST(ScipProtocol, StatusInPlainWords) {
  EXPECT_THAT(scip::StatusText("MD", "55"), HasSubstr("out of order"));
  EXPECT_THAT(scip::StatusText("TM0", "02"), HasSubstr("already"));
  EXPECT_THAT(scip::StatusText("BM", "01"), HasSubstr("laser"));
  EXPECT_THAT(scip::StatusText("XX", "\x01z"), HasSubstr("status \"?z\""));
}

std::string ScanBytes() {
  std::string bytes = "MD0002000401000\n99b\nm2@0";
  bytes += std::string(1, scip::Checksum("m2@0")) + "\n";
  const std::string data = "0Cb00100m";
  return bytes + data + scip::Checksum(data) + "\n\n";
}

TEST(ScipProtocol, AScan) {
  const scip::Scan scan = scip::ParseScan(BlockOf(ScanBytes()));
  EXPECT_EQ(scan.time_ms, 16'000'000u);
  EXPECT_THAT(scan.range_mm, ElementsAre(0x13u * 64 + 0x32, 1u, 0x3du));
  EXPECT_TRUE(scan.intensity.empty());
}

TEST(ScipProtocol, AnyChangedByteIsRefusedOrHarmless) {
  const std::string good = ScanBytes();
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = good;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int c = 0; c < changes; ++c) bytes[random() % bytes.size()] = static_cast<char>(random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    scip::BlockReader reader;
    reader.Append(bytes + "\n\n");
    while (const auto block = reader.Take()) {
      const auto parse = [&](auto parser) {
        refused += WhatThrows([&] { parser(*block); }) != "nothing" ? 1 : 0;
      };
      parse(scip::ParseScan);
      parse(scip::ParseTime);
      parse(scip::ParseParameters);
    }
  }
  EXPECT_GT(refused, 10'000);
}

TEST(ScipProtocol, BlocksSurviveAnySplit) {
  const std::string bytes =
      std::string("\n\n") + kParametersReply + "QT\r\n00P\r\n\r\n\n" + ScanBytes();
  for (std::size_t piece = 1; piece < 40; ++piece) {
    scip::BlockReader reader;
    std::vector<scip::Block> blocks;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      reader.Append(std::string_view(bytes).substr(at, piece));
      while (auto block = reader.Take()) blocks.push_back(*std::move(block));
    }
    ASSERT_EQ(blocks.size(), 3u) << piece;
    EXPECT_EQ(blocks[1].echo(), "QT");
    EXPECT_EQ(blocks[1].status(), "00");
    EXPECT_EQ(scip::ParseScan(blocks[2]).range_mm.size(), 3u);
  }
}

TEST(ScipProtocol, RubbishWithoutEndIsGivenUp) {
  scip::BlockReader reader;
  const std::string rubbish(scip::BlockReader::kMaxBytes + 1, 'x');
  reader.Append(rubbish);
  EXPECT_FALSE(reader.Take());
  EXPECT_GT(reader.given_up(), 0);
  reader.Append(kParametersReply);
  EXPECT_EQ(reader.Take()->echo(), "PP");
}

// What the scripted scanner sees: the scan's number in the first beam, then a ramp with misses.
ScipPeerScan Ramp(const ScipPeerOptions& options, std::int64_t index) {
  ScipPeerScan scan;
  for (int step = options.first_step; step <= options.last_step; ++step) {
    const auto k = static_cast<std::uint32_t>(step - options.first_step);
    scan.range_mm.push_back(k == 0        ? 1000 + static_cast<std::uint32_t>(index % 50'000)
                            : k % 10 == 3 ? 1 + k % 5
                                          : 2000 + 3 * k);
    scan.intensity.push_back(k == 1 ? 100'000 : 10 * k);
  }
  return scan;
}

ScipPeerOptions PeerOptions() {
  ScipPeerOptions options;
  options.first_step = 100;
  options.last_step = 300;
  options.front_step = 200;
  options.clock_rate = 1 + 50e-6;
  options.clock_start_ms = (1 << 24) - 1500.25;  // wraps soon
  options.scan = [options](std::int64_t index, double) { return Ramp(options, index); };
  return options;
}

std::int64_t IndexOf(const LineScan& line) { return std::llround(line.range[0] * 1000) - 1000; }

// Runs a driver against a peer.
struct Rig {
  explicit Rig(ScipPeerOptions options)
      : peer(std::move(options)),
        scanner({"127.0.0.1", peer.port()}),
        thread([this](DeviceThread& self) { scanner.Serve(self); }) {}

  bool WaitForLines(std::size_t count) {
    return Collect(&thread, &collected,
                   [&](const Collected& t) { return t.Count<LineScan>() >= count; });
  }
  bool WaitForProblem(const std::string& part) {
    return Collect(&thread, &collected, [&](const Collected& t) { return t.HasWarning(part); });
  }

  ScipPeer peer;
  ScipScanner scanner;
  Collected collected;
  DeviceThread thread;
};

TEST(ScipScanner, AStreamAgainstTheTruth) {
  const ScipPeerOptions options = PeerOptions();
  Rig rig(options);
  ASSERT_TRUE(rig.WaitForLines(160));  // 4 s
  std::vector<double> errors_us;
  for (const LineScan& line : rig.collected.All<LineScan>()) {
    ASSERT_EQ(line.range.size(), 201u);
    EXPECT_NEAR(line.first_angle_rad, -100 * 2 * M_PI / 1440, 1e-12);
    EXPECT_NEAR(line.angle_step_rad, 2 * M_PI / 1440, 1e-12);
    EXPECT_NEAR(line.beam_period_s, 0.025 / 1440, 1e-12);
    EXPECT_TRUE(std::isnan(line.range[3]));
    EXPECT_FLOAT_EQ(line.range[20], 2.06F);
    EXPECT_EQ(line.intensity[1], 1.0F);
    EXPECT_FLOAT_EQ(line.intensity[20], 200 / 65535.0F);
    const double first_beam = rig.peer.StepZero(IndexOf(line)) + 100 * 25'000.0 / 1440;
    errors_us.push_back(static_cast<double>(line.utime) - first_beam);
  }
  std::sort(errors_us.begin(), errors_us.end());
  const double median = errors_us[errors_us.size() / 2];
  RecordProperty("median_us", std::to_string(median));
  RecordProperty("least_us", std::to_string(errors_us.front()));
  RecordProperty("most_us", std::to_string(errors_us.back()));
  // A tick is 1000 us; what the machine adds under load only delays replies.
  EXPECT_LT(std::abs(median), 1500);
  const Status status = rig.scanner.report().GetStatus();
  EXPECT_TRUE(status.ready);
  EXPECT_THAT(status.text, HasSubstr("UTM-30LX-EW"));
  EXPECT_TRUE(rig.collected.warnings.empty()) << rig.collected.warnings[0];
}

TEST(ScipScanner, TellsBadScansAndGoesOn) {
  Rig rig(PeerOptions());
  ASSERT_TRUE(rig.WaitForLines(3));
  rig.peer.Inject(ScipPeer::Fault::kBadChecksum);
  rig.peer.Inject(ScipPeer::Fault::kPieces);
  ASSERT_TRUE(rig.WaitForProblem("wrong checksum"));
  rig.peer.Inject(ScipPeer::Fault::kRubbish);
  ASSERT_TRUE(rig.WaitForProblem("status"));
  ASSERT_TRUE(rig.WaitForLines(rig.collected.Count<LineScan>() + 3));
  EXPECT_GE(rig.scanner.report().count("bad lines"), 1);
  EXPECT_GE(rig.scanner.report().count("lost lines"), 1);
  EXPECT_EQ(rig.peer.clients(), 1);
}

TEST(ScipScanner, ConnectsAgainAndTellsTheGap) {
  for (const auto& [fault, why] : {std::pair(ScipPeer::Fault::kClose, "closed the connection"),
                                   std::pair(ScipPeer::Fault::kSilent, "sends no scans")}) {
    Rig rig(PeerOptions());
    ASSERT_TRUE(rig.WaitForLines(3));
    rig.peer.Inject(fault);
    ASSERT_TRUE(rig.WaitForProblem(why));
    EXPECT_TRUE(rig.collected.HasWarning("127.0.0.1:" + std::to_string(rig.peer.port())));
    ASSERT_TRUE(rig.WaitForProblem("is back; no lines for"));
    ASSERT_TRUE(rig.WaitForLines(rig.collected.Count<LineScan>() + 3));
    EXPECT_EQ(rig.peer.clients(), 2);
    EXPECT_EQ(rig.scanner.report().count("reconnects"), 1);
  }
}

TEST(ScipScanner, WithoutIntensitiesAndTimeMode) {
  ScipPeerOptions options = PeerOptions();
  options.intensities = false;
  options.time_mode = false;
  Rig rig(options);
  ASSERT_TRUE(rig.WaitForLines(5));
  EXPECT_TRUE(rig.collected.All<LineScan>()[0].intensity.empty());
  EXPECT_TRUE(rig.collected.HasWarning("does not tell its time"));
  EXPECT_THAT(rig.peer.commands(), ElementsAre("TM2", "QT", "SCIP2.0", "VV", "PP", "TM0",
                                               "ME0100030001000", "MD0100030001000"));
}

TEST(ScipScanner, ThatWasLeftInItsTimeMode) {
  ScipPeerOptions options = PeerOptions();
  options.time_mode_on = true;
  Rig rig(options);
  ASSERT_TRUE(rig.WaitForLines(3));
  EXPECT_TRUE(rig.collected.warnings.empty());
}

TEST(ScipScanner, NobodyThereSaysWhatToDo) {
  int port = 0;
  {
    const ScipPeer gone(PeerOptions());
    port = gone.port();
  }
  ScipScanner scanner({"127.0.0.1", port});
  DeviceThread thread([&](DeviceThread& self) { scanner.Serve(self); });
  Collected collected;
  ASSERT_TRUE(Collect(&thread, &collected, [](const Collected& t) { return !t.warnings.empty(); }));
  EXPECT_THAT(collected.warnings[0], HasSubstr("is it switched on"));
  EXPECT_FALSE(scanner.report().GetStatus().ready);
}

TEST(ScipScanner, LeavesTheScannerQuiet) {
  auto rig = std::make_unique<Rig>(PeerOptions());
  ASSERT_TRUE(rig->WaitForLines(2));
  rig->thread.Stop();
  const auto quit = [&] { return rig->peer.commands().back() == "QT"; };
  for (int i = 0; i < 1000 && !quit(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_TRUE(quit());
}

}  // namespace
}  // namespace rgbdt
