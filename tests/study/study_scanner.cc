// How exactly the turned scanner's geometry is found, against the synthetic truth.
// Usage: study_scanner TURN FIRST_SEED SEEDS OUT.csv
// TURN: small (the guess is 5 mm and 0.5 degrees off about each axis), large (20 mm and 2 degrees),
// dense (as small, a sweep of four times the points), short (as small, 270 of 360 degrees).
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/study/scanner_scenes.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

using simulate::kDegree;

simulate::ScannerOptions ScannerOf(const std::string& turn) {
  simulate::ScannerOptions scanner = simulate::FullTurnScanner();
  if (turn == "short") scanner.sweep_rad = 270 * kDegree;
  if (turn == "dense") {
    scanner.beams *= 2;
    scanner.angle_step_rad /= 2;
    scanner.motor_speed_rad_s /= 4;
  }
  return scanner;
}

ScannerError ErrorOf(const std::string& turn) {
  return turn == "large" ? ScannerError{0.02, 2 * kDegree} : ScannerError();
}

void Run(const std::string& turn, std::uint64_t first, std::uint64_t seeds,
         const std::string& path) {
  if (turn != "small" && turn != "large" && turn != "dense" && turn != "short") {
    throw std::runtime_error("TURN is " + turn + "; there are: small, large, dense, short");
  }
  std::ofstream csv(path);
  const char* names[] = {"rx", "ry", "tx", "ty"};
  csv << "sensor,seed,converged,patches,gap_before_mm,gap_after_mm,range_sigma_mm,chi2";
  for (const char* name : names) csv << ',' << name << ",sigma_" << name;
  csv << '\n';
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const ScannerCase made = MakeScannerCase(seed, ErrorOf(turn), ScannerOf(turn));
    const ScannerGeometry found = FindScannerGeometry(made.guess, {made.beams});
    const Eigen::Vector4d error =
        ScannerErrorOf(made.truth.motor_from_scanner, found.scanner.motor_from_scanner);
    const Eigen::Matrix4d covariance = ObservableCovariance(found);
    csv << turn << ',' << seed << ',' << found.converged << ',' << found.surfaces.size() << ','
        << 1000 * found.gap_before_m << ',' << 1000 * found.gap_after_m << ','
        << 1000 * found.range_sigma_m << ',' << error.dot(covariance.inverse() * error);
    for (int i = 0; i < 4; ++i) {
      const double unit = i < 2 ? 1 / kDegree : 1000;
      csv << ',' << unit * error[i] << ',' << unit * std::sqrt(covariance(i, i));
    }
    csv << '\n';
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(arguments[0], std::stoull(arguments[1]), std::stoull(arguments[2]),
                      arguments[3]);
  };
  return rgbdt::study::StudyMain(
      {"study_scanner", "small|large|dense|short FIRST_SEED SEEDS CSV", 4, 4, run}, argc, argv);
}
