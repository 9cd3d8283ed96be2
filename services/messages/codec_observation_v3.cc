#include "services/messages/check.h"
#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

void CheckScatter(const std::string& part, const board_scatter_t& wire,
                  const std::vector<board_crossing_t>& crossings) {
  CheckPart(part, wire);
  CheckLength(part + ".crossing_sigma_m", wire.crossing_sigma_m.size(), crossings.size(), false);
}

}  // namespace

observation_v3_t ToWire(const Observation& observation) {
  observation_v3_t wire{};
  wire.observation = ToSecondVersion(observation);
  if (observation.cloud) wire.cloud_scatter = ScatterToWire(*observation.cloud);
  wire.num_candidate_scatters = CountOf(observation.candidates.size(), "num_candidate_scatters");
  wire.candidate_scatter.reserve(observation.candidates.size());
  for (const CloudEdges& candidate : observation.candidates) {
    wire.candidate_scatter.push_back(ScatterToWire(candidate));
  }
  return wire;
}

void Check(const observation_v3_t& wire) {
  const observation_v2_t& second = wire.observation;
  Check(second);
  if (second.observation.has_cloud != 0) {
    CheckScatter("cloud_scatter", wire.cloud_scatter, second.cloud_crossing);
  }
  CheckLength("candidate_scatter", wire.candidate_scatter.size(), second.candidate.size(), false);
  for (std::size_t i = 0; i < wire.candidate_scatter.size(); ++i) {
    CheckScatter(At("candidate_scatter", i), wire.candidate_scatter[i],
                 second.candidate[i].crossing);
  }
}

Observation FromWire(const observation_v3_t& wire) {
  Observation observation = FromWire(wire.observation);
  if (observation.cloud) ScatterFromWire(wire.cloud_scatter, &*observation.cloud);
  for (std::size_t i = 0; i < observation.candidates.size(); ++i) {
    ScatterFromWire(wire.candidate_scatter[i], &observation.candidates[i]);
  }
  return observation;
}

}  // namespace rgbdt
