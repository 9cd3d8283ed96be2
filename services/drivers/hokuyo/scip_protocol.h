#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// SCIP 2.0, as bytes: Hokuyo's "Communication Protocol Specification for SCIP2.0 Standard",
/// C-42-03320B; section numbers below are of that text. No clock, no socket. What is malformed
/// throws InputError, never more.
namespace rgbdt::scip {

/// The sum at a line's end: the lower 6 bits of the sum of its bytes, plus 30H (section 7).
char Checksum(std::string_view text);

/// A number of 1 to 4 characters, 6 bits each plus 30H, the highest first (section 6); nothing
/// where a character is none of those.
std::optional<std::uint32_t> Decode(std::string_view characters);

/// Commands, with their line feed.
inline constexpr std::string_view kUseScip2 = "SCIP2.0\n";
inline constexpr std::string_view kLaserOn = "BM\n";
inline constexpr std::string_view kQuit = "QT\n";   ///< laser off, no more scans
inline constexpr std::string_view kReset = "RS\n";  ///< also its clock
inline constexpr std::string_view kVersion = "VV\n";
inline constexpr std::string_view kParameters = "PP\n";
inline constexpr std::string_view kState = "II\n";
inline constexpr std::string_view kTimeModeOn = "TM0\n";
inline constexpr std::string_view kTime = "TM1\n";
inline constexpr std::string_view kTimeModeOff = "TM2\n";
/// Scans without end, every step from first to last: MD (distances), or ME (and intensities).
std::string MeasureCommand(bool intensities, int first_step, int last_step);

/// A reply: lines up to an empty one, without their line feeds.
struct Block {
  std::vector<std::string> lines;
  std::string_view echo() const { return lines.empty() ? std::string_view() : lines[0]; }
  /// "00", "99", ...; empty where there is none or its sum is wrong.
  std::string_view status() const;
};

/// Cuts what comes over the wire into blocks, however it is split or merged. Rubbish makes at most
/// wrong blocks; without an end it is given up.
class BlockReader {
 public:
  static constexpr std::size_t kMaxBytes = 256 * 1024;  ///< of a block; a scan takes about 8 KB
  void Append(std::string_view bytes);
  std::optional<Block> Take();
  std::int64_t given_up() const { return given_up_; }  ///< bytes

 private:
  std::string bytes_;
  std::size_t searched_ = 0;
  std::int64_t given_up_ = 0;
};

/// What a status means, for a person: of commands in general (section 9), of a measurement (8.1)
/// and of the time mode (8.6).
std::string StatusText(std::string_view echo, std::string_view status);

/// The scanner (PP, section 8.12). A turn has `steps`, counted anticlockwise as seen from above.
struct Parameters {
  std::string model;
  int least_mm = 0, most_mm = 0;      ///< DMIN, DMAX
  int steps = 0;                      ///< ARES: of a full turn
  int first_step = 0, last_step = 0;  ///< AMIN, AMAX: where it measures
  int front_step = 0;                 ///< AFRT: straight ahead
  int rpm = 0;                        ///< SCAN
  double step_rad() const;
  double first_angle_rad() const;  ///< of first_step, from straight ahead
  double beam_period_s() const { return 60.0 / rpm / steps; }
};
Parameters ParseParameters(const Block& block);

/// The time in a reply to TM1 [ms, wraps at 2^24].
std::uint32_t ParseTime(const Block& block);

/// A measurement (section 8.1).
struct Scan {
  int first_step = 0, last_step = 0;
  int remaining = 0;          ///< scans to come, 0 where they have no end
  std::uint32_t time_ms = 0;  ///< of the scanner's clock, wraps at 2^24; of step 0, not first_step
  std::vector<std::uint32_t> range_mm;   ///< one a step; below DMIN: an error's number
  std::vector<std::uint32_t> intensity;  ///< ME: 0 to 2^18 - 1; MD: empty
};
bool IsScan(const Block& block);  ///< a scan's data, good or not; not the echo of the command
Scan ParseScan(const Block& block);

}  // namespace rgbdt::scip
