#include <glog/logging.h>

#include "services/command_line/command_line.h"
#include "services/rgbdt/packet_import.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

int main(int argc, char** argv) {
  // Ceres warns of each step that fails, silent or not; what came of the solve stands in its
  // result.
  FLAGS_minloglevel = google::GLOG_ERROR;
  rgbdt::CommandLine line(
      "rgbdt",
      "rgbdt: where a colour and a thermal camera sit relative to a LIDAR, and their fused cloud.\n"
      "Example: rgbdt simulate out/synthetic && rgbdt calibrate out/synthetic");
  rgbdt::AddVerdictEnds(&line, "calibrate, evaluate, refine, replay: ");
  rgbdt::AddSession(&line);
#ifdef RGBDT_HAS_DRIVERS
  const rgbdt::PacketImport packets{rgbdt::ImportPackets, rgbdt::ImportPacketsAsSession,
                                    rgbdt::ReadPacketsInBag};
  rgbdt::AddImport(&line, &packets);
#else
  rgbdt::AddImport(&line, nullptr);
#endif
  rgbdt::AddCalibrate(&line);
  rgbdt::AddEvaluate(&line);
  rgbdt::AddRefine(&line);
  rgbdt::AddCompare(&line);
  rgbdt::AddFuse(&line);
#ifdef RGBDT_HAS_SIMULATOR
  rgbdt::AddSimulate(&line);
#endif
  rgbdt::AddReplay(&line);
  rgbdt::AddIntrinsics(&line);
  rgbdt::AddScanner(&line);
  rgbdt::AddSync(&line);
  rgbdt::AddMap(&line);
  rgbdt::AddTerrain(&line);
  rgbdt::AddExport(&line);
  rgbdt::AddUp(&line);
  rgbdt::AddKey(&line);
#ifdef RGBDT_HAS_DRIVERS
  rgbdt::AddDoctor(&line);
#endif
  return line.Run(argc, argv);
}
