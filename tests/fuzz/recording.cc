// A recording of a LIDAR's packets, as `rgbdt import` reads it. The first byte: whose metadata are
// given (none, an Ouster's, a Hesai's, or what comes first in the input).
#include "services/packets/recording.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/packets/hesai_encoder.h"
#include "tests/unit/packets/ouster_encoder.h"

namespace rgbdt {
namespace {

void TakeInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::ScratchFile file("recording.pcap"), metadata("metadata");
  static const std::string ouster = test::OusterEncoder().Metadata();
  static const std::string hesai = test::HesaiEncoder().Angles();
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte() % 4;
  RecordingOptions options;
  if (kind != 0) {
    options.metadata = metadata.path();
    metadata.Write(kind == 1 ? ouster : kind == 2 ? hesai : input.Piece());
  }
  file.Write(input.Rest());
  fuzz::Try([&] {
    std::int64_t sweeps = 0;
    const Recording recording = ReadRecording(file.path(), options, [&](const Cloud& sweep) {
      fuzz::RequireWhole(sweep);
      ++sweeps;
    });
    fuzz::Require(recording.sweeps == sweeps, "as many sweeps as were given");
    for (const std::string& line :
         {recording.sensor, recording.last_problem, recording.lost, recording.cut_off}) {
      fuzz::Require(line.find('\n') == std::string::npos, "one line; it says: " + line);
    }
  });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
