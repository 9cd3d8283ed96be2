// A log with RIG, ENCODER and LINE_SCAN of one full turn in the synthetic room; the rig file in it
// is wrong about the scanner. Usage: scanner_test_log LOG RIG: RIG is the rig file to put into it.
#include <cstdio>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/simulate/simulator.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"
#include "services/simulator/simulator_node.h"

namespace rgbdt {
namespace {

void Write(const Message& message, Utime utime, LogWriter* log) {
  log->Write(ChannelOf(message), Encode(message), utime);
}

void WriteSweep(const simulate::Simulator& simulator, LogWriter* log) {
  const Utime start = SimulatorNode::kEpoch;
  const Utime end = start + simulator.sweep_lines() * simulator.line_period();
  std::int64_t seq = 0;
  for (Utime t = start; t < end + SimulatorNode::kEncoderPeriod;
       t += SimulatorNode::kEncoderPeriod) {
    EncoderReading reading = simulator.Encoder(t, start);
    reading.seq = seq++;
    Write(reading, t, log);
  }
  for (int i = 0; i < simulator.sweep_lines(); ++i) {
    LineScan line = simulator.Line(start, i);
    line.seq = i;
    Write(line, line.utime, log);
  }
}

}  // namespace

void WriteLog(const char* log_path, const char* rig_path) {
  simulate::Options options;
  options.scene = simulate::Scene::kIndoor;
  options.scanner = simulate::FullTurnScanner();
  const simulate::Simulator simulator(options);
  const std::string text = ReadWholeFile(rig_path);
  LogWriter log(log_path);
  Write(RigText{0, HashOfRigText(text), text}, SimulatorNode::kEpoch, &log);
  WriteSweep(simulator, &log);
  log.Close();
}

}  // namespace rgbdt

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: scanner_test_log LOG RIG\n");
    return 1;
  }
  rgbdt::WriteLog(argv[1], argv[2]);
  return 0;
}
