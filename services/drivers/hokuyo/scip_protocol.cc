#include "services/drivers/hokuyo/scip_protocol.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/model/errors.h"

namespace rgbdt::scip {
namespace {

constexpr int kMostSteps = 100'000;  // finer than any scanner

[[noreturn]] void Fail(const std::string& what) { throw InputError("SCIP: " + what); }

// What a person may be shown of a line.
std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, 40)) quoted += c >= ' ' && c <= '~' ? c : '?';
  return quoted + '"';
}

// A line without the sum at its end.
std::string_view Summed(const std::string& line, const char* what) {
  const std::string_view all = line;
  if (all.empty() || Checksum(all.substr(0, all.size() - 1)) != all.back()) {
    Fail(std::string(what) + " has a wrong checksum: " + Quote(all));
  }
  return all.substr(0, all.size() - 1);
}

std::optional<int> Digits(std::string_view text) {
  if (text.empty() || text.size() > 9) return std::nullopt;
  int value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    value = 10 * value + (c - '0');
  }
  return value;
}

// "NAME:value;sum". The sum is of the text before the semicolon, in some firmware with it, in some
// without a remark that begins with "<-".
std::optional<std::string_view> ValueOf(std::string_view line, std::string_view name) {
  if (line.size() < name.size() + 3 || line.substr(0, name.size()) != name ||
      line[name.size()] != ':' || line[line.size() - 2] != ';') {
    return std::nullopt;
  }
  const std::string_view text = line.substr(0, line.size() - 2);
  const std::string_view unremarked = text.substr(0, text.find("<-"));
  const char sum = line.back();
  if (sum != Checksum(text) && sum != Checksum(line.substr(0, line.size() - 1)) &&
      sum != Checksum(unremarked)) {
    Fail("the line " + Quote(line) + " has a wrong checksum");
  }
  return unremarked.substr(name.size() + 1);
}

int NumberOf(const Block& block, const char* name, int least, int most) {
  for (const std::string& line : block.lines) {
    const auto value = ValueOf(line, name);
    if (!value) continue;
    const std::size_t begin = value->find_first_not_of(' ');
    const auto number =
        begin == std::string_view::npos ? std::nullopt : Digits(value->substr(begin));
    if (number && *number >= least && *number <= most) return *number;
    Fail(std::string("the scanner's ") + name + " is " + Quote(*value) + "; expected " +
         std::to_string(least) + " to " + std::to_string(most));
  }
  Fail(std::string("the scanner does not tell its ") + name);
}

std::uint32_t DecodeTime(const std::string& line) {
  const std::string_view text = Summed(line, "a time");
  const auto time = text.size() == 4 ? Decode(text) : std::nullopt;
  if (!time) Fail("expected a time of 4 characters, got " + Quote(text));
  return *time;
}

// All lines of data, one after the other.
std::string JoinData(const Block& block) {
  std::string data;
  for (std::size_t i = 3; i < block.lines.size(); ++i) {
    data += Summed(block.lines[i], "a line of a scan");
  }
  return data;
}

std::uint32_t DecodeAt(const std::string& data, std::size_t at) {
  const auto value = Decode(std::string_view(data).substr(at, 3));
  if (!value)
    Fail("a scan holds " + Quote(data.substr(at, 3)) + "; expected 3 characters of '0' to 'o'");
  return *value;
}

}  // namespace

char Checksum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3f) + 0x30);
}

std::optional<std::uint32_t> Decode(std::string_view characters) {
  if (characters.empty() || characters.size() > 4) return std::nullopt;
  std::uint32_t value = 0;
  for (const char c : characters) {
    if (c < 0x30 || c > 0x6f) return std::nullopt;
    value = value << 6 | static_cast<std::uint32_t>(c - 0x30);
  }
  return value;
}

std::string MeasureCommand(bool intensities, int first_step, int last_step) {
  char command[40];
  std::snprintf(command, sizeof(command), "M%c%04d%04d01000\n", intensities ? 'E' : 'D', first_step,
                last_step);
  return command;
}

std::string_view Block::status() const {
  if (lines.size() < 2) return {};
  const std::string_view line = lines[1];
  // SCIP2.0 itself is answered without a sum.
  if (lines[0] == "SCIP2.0") return line;
  if (line.size() != 3 || Checksum(line.substr(0, 2)) != line[2]) return {};
  return line.substr(0, 2);
}

void BlockReader::Append(std::string_view bytes) {
  for (const char c : bytes) {
    if (c != '\r') bytes_ += c;
  }
}

std::optional<Block> BlockReader::Take() {
  const std::size_t begin = bytes_.find_first_not_of('\n');
  if (begin == std::string::npos) {
    bytes_.clear();
    searched_ = 0;
    return std::nullopt;
  }
  if (begin > 0) {
    bytes_.erase(0, begin);
    searched_ = 0;
  }
  const std::size_t end = bytes_.find("\n\n", searched_);
  if (end == std::string::npos) {
    searched_ = bytes_.size() - 1;
    if (bytes_.size() > kMaxBytes) {
      given_up_ += static_cast<std::int64_t>(bytes_.size());
      bytes_.clear();
      searched_ = 0;
    }
    return std::nullopt;
  }
  Block block;
  for (std::size_t at = 0; at < end;) {
    const std::size_t stop = std::min(bytes_.find('\n', at), end);
    block.lines.push_back(bytes_.substr(at, stop - at));
    at = stop + 1;
  }
  bytes_.erase(0, end + 2);
  searched_ = 0;
  return block;
}

std::string StatusText(std::string_view echo, std::string_view status) {
  std::string code = "status " + Quote(status);
  const std::string_view verb = echo.substr(0, 2);
  const bool measures = verb == "MD" || verb == "ME" || verb == "MS";
  const auto number = Digits(status);
  if (status == "00") return "accepted";
  if (status == "0A") return code + ": it could not make sense of the command";
  if (status == "0B") return code + ": its memory is full";
  if (status == "0C") return code + ": it knows no such command";
  if (status == "0D") return code + ": the command's end was not understood";
  if (status == "0E") return code + ": it knows no such command or not in this mode";
  if (status == "10") return code + ": its laser is off or out of order";
  if (verb == "TM") {
    if (status == "01") return code + ": no such time mode";
    if (status == "02") return code + ": it is in its time mode already";
    if (status == "03") return code + ": it has left its time mode already";
    if (status == "04") return code + ": it is not in its time mode";
  }
  if (verb == "BM") {
    if (status == "01") return code + ": its laser does not work";
    if (status == "02") return code + ": its laser is on already";
  }
  if (measures && number) {
    if (*number >= 1 && *number <= 7) return code + ": the command's steps or counts are wrong";
    if (*number >= 21 && *number <= 49) return code + ": it stopped to look for an error";
    if (*number >= 50 && *number <= 97) {
      return code + ": its laser, motor or another part is out of order";
    }
    if (*number == 98) return code + ": it goes on after an error";
    if (*number == 99) return "a scan";
  }
  return code;
}

double Parameters::step_rad() const { return 2 * M_PI / steps; }

double Parameters::first_angle_rad() const { return (first_step - front_step) * step_rad(); }

Parameters ParseParameters(const Block& block) {
  if (block.echo() != "PP" || block.status() != "00") {
    Fail("the scanner does not tell its parameters: " + StatusText("PP", block.status()));
  }
  Parameters p;
  for (const std::string& line : block.lines) {
    if (const auto model = ValueOf(line, "MODL")) p.model = *model;
  }
  p.least_mm = NumberOf(block, "DMIN", 0, 1'000'000);
  p.most_mm = NumberOf(block, "DMAX", p.least_mm + 1, 1'000'000);
  p.steps = NumberOf(block, "ARES", 4, kMostSteps);
  p.first_step = NumberOf(block, "AMIN", 0, 9999);
  p.last_step = NumberOf(block, "AMAX", p.first_step, 9999);
  p.front_step = NumberOf(block, "AFRT", 0, 9999);
  p.rpm = NumberOf(block, "SCAN", 1, 100'000);
  return p;
}

std::uint32_t ParseTime(const Block& block) {
  if (block.echo().substr(0, 3) != "TM1" || block.status() != "00" || block.lines.size() != 3) {
    Fail("the scanner does not tell its time: " + StatusText("TM1", block.status()));
  }
  return DecodeTime(block.lines[2]);
}

bool IsScan(const Block& block) {
  const std::string_view echo = block.echo().substr(0, 2);
  return (echo == "MD" || echo == "ME") && block.lines.size() >= 3;
}

Scan ParseScan(const Block& block) {
  const std::string_view echo = block.echo();
  if (!IsScan(block) || echo.size() < 15 || block.status() != "99") {
    Fail("expected a scan, got " + Quote(echo) + ", " + StatusText(echo, block.status()));
  }
  const auto first = Digits(echo.substr(2, 4));
  const auto last = Digits(echo.substr(6, 4));
  const auto cluster = Digits(echo.substr(10, 2));
  const auto remaining = Digits(echo.substr(13, 2));
  if (!first || !last || !cluster || !remaining || *last < *first || *cluster > 1) {
    Fail("a scan's header " + Quote(echo) + " is not that of the scans asked for");
  }
  Scan scan;
  scan.first_step = *first;
  scan.last_step = *last;
  scan.remaining = *remaining;
  scan.time_ms = DecodeTime(block.lines[2]);
  const std::string data = JoinData(block);
  const bool intensities = echo[1] == 'E';
  const std::size_t stride = intensities ? 6 : 3;
  const auto steps = static_cast<std::size_t>(*last - *first + 1);
  if (data.size() != steps * stride) {
    Fail("a scan of steps " + std::to_string(*first) + " to " + std::to_string(*last) + " holds " +
         std::to_string(data.size()) + " characters; expected " + std::to_string(steps * stride));
  }
  scan.range_mm.reserve(steps);
  if (intensities) scan.intensity.reserve(steps);
  for (std::size_t at = 0; at < data.size(); at += stride) {
    scan.range_mm.push_back(DecodeAt(data, at));
    if (intensities) scan.intensity.push_back(DecodeAt(data, at + 3));
  }
  return scan;
}

}  // namespace rgbdt::scip
