// What a Hokuyo scanner sends. Where the first byte is odd each line behind a block's first gets
// the sum that it should have.
#include "services/drivers/hokuyo/scip_protocol.h"
#include "services/drivers/hokuyo/scip_scanner.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

// Lines of a version or of parameters have a semicolon before the sum.
std::string WithSums(const std::string& text) {
  std::string out;
  bool first = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    at = end + 1;
    const bool empty = line.empty();
    if (!empty && !first) {
      std::string_view summed = line;
      if (summed.back() == ';') summed.remove_suffix(1);
      line += scip::Checksum(summed);
    }
    out += line + '\n';
    first = empty;
  }
  return out;
}

void Parse(const scip::Block& block) {
  fuzz::Require(!scip::StatusText(block.echo(), block.status()).empty(), "a status in words");
  scip::Parameters scanner;
  scanner.least_mm = 23;
  scanner.most_mm = 60'000;
  scanner.steps = 1440;
  scanner.rpm = 2400;
  fuzz::Try([&] { scanner = scip::ParseParameters(block); });
  fuzz::Try([&] { scip::ParseTime(block); });
  fuzz::Try([&] {
    const LineScan line = ToLineScan(scanner, scip::ParseScan(block), 1'700'000'000'000'000);
    fuzz::Require(line.intensity.empty() || line.intensity.size() == line.range.size(),
                  "as many intensities as ranges, or none");
  });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  const bool sums = input.Byte() % 2 == 1;
  const std::size_t piece = 1 + std::size_t{16} * input.Byte();
  std::string text = input.Rest();
  if (sums) text = WithSums(text);
  scip::BlockReader reader;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    reader.Append(std::string_view(text).substr(at, piece));
    while (const auto block = reader.Take()) Parse(*block);
  }
  return 0;
}
