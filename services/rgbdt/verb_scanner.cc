#include <cstdio>
#include <memory>

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/schema/rig_file.h"
#include "calib/present/pictures/scanner_picture.h"
#include "calib/scan_assembly/scanner_geometry.h"
#include "services/replay/scanner_sweeps.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

struct ScannerFlags {
  std::string input, out = "out/scanner/rig.textproto";
};

void PrintTransform(const TurnedScanner& before, const TurnedScanner& after) {
  std::printf(
      "motor_from_scanner: point_in_motor = R * point_in_scanner + t; in the scanner's frame the "
      "scan plane is x-z, angles count from x towards z\n");
  const auto print = [](const char* what, const TurnedScanner& scanner) {
    const Eigen::Quaterniond& q = scanner.motor_from_scanner.rotation;
    const Eigen::Vector3d t = 1000 * scanner.motor_from_scanner.translation;
    std::printf("  %-7s quaternion_wxyz %.7f %.7f %.7f %.7f, t %.2f %.2f %.2f mm\n", what, q.w(),
                q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
  };
  print("before", before);
  print("after", after);
}

void WriteScanner(const ScannerFlags& flags, const ScannerSweeps& input,
                  const ScannerGeometry& found) {
  Rig rig = input.rig;
  rig.lidar.turned_scanner = found.scanner;
  const fs::path out = flags.out, picture = out.parent_path() / "scanner.png";
  WritePng(picture, ScannerPicture(*input.rig.lidar.turned_scanner, found, input.sweeps));
  WriteFileAtomically(out, PrintRig(rig));
  std::printf(
      "wrote %s (comments of the old file are not kept) and %s\n"
      "next: use that rig file from now on. Clouds and calibrations made with the old one keep its "
      "error: replay their logs, or sweep and calibrate anew\n",
      out.c_str(), picture.c_str());
}

int RunScanner(const ScannerFlags& flags) {
  CheckWritable(flags.out);
  const ScannerSweeps input = ReadScannerSweeps(flags.input);
  PrintUnreadable(input.problems, "not used");
  const TurnedScanner& before = *input.rig.lidar.turned_scanner;
  ScannerGeometryOptions options;
  options.range_sigma_m = input.rig.lidar.range_sigma_m;
  const ScannerGeometry found = FindScannerGeometry(before, input.sweeps, options);
  std::printf("%zu sweep%s of %s: %s", input.sweeps.size(), input.sweeps.size() == 1 ? "" : "s",
              flags.input.c_str(), found.BriefReport().c_str());
  if (!found.converged) {
    std::printf("no rig file was written\n");
    return EndsWith(false);
  }
  PrintTransform(before, found.scanner);
  WriteScanner(flags, input, found);
  return EndsWith(true);
}

}  // namespace

void AddScanner(CommandLine* program) {
  auto flags = std::make_shared<ScannerFlags>();
  CommandLine* verb = program->Verb(
      "scanner",
      "Finds where the turned scanner sits on its motor (lever arm and tilt) from any room at "
      "rest:\n"
      "surfaces seen by both halves of the scan line, half a turn apart, must not be double. One\n"
      "sweep by 360 degrees is enough, with a scan line that reaches over the vertical. Reports\n"
      "what the sweep cannot determine. Writes the rig with the geometry, and scanner.png beside "
      "it.\n"
      "Example: rgbdt scanner out/room",
      [flags] { return RunScanner(*flags); });
  verb->Ends(ExitCode::kFailed, "failed, or not converged; nothing was written");
  verb->Required("DIR", &flags->input,
                 "session directory (rig.textproto, views/ with organised clouds made with it; "
                 "images are not needed), or a log with RIG, LINE_SCAN and ENCODER");
  verb->Option("--out", &flags->out, "the rig file to write");
}

}  // namespace rgbdt
