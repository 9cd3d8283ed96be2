#include "viewer/live/wave_history.h"

#include <cmath>
#include <utility>

namespace rgbdt::viewer {
namespace {

const char* NameOf(WavePhase phase) {
  switch (phase) {
    case WavePhase::kRecording:
      return "recording";
    case WavePhase::kSolving:
      return "solving";
    case WavePhase::kDone:
      return "done";
    case WavePhase::kFailed:
      return "failed";
    case WavePhase::kWaiting:
      break;
  }
  return "waiting";
}

bool IsOver(WavePhase phase) { return phase == WavePhase::kDone || phase == WavePhase::kFailed; }

constexpr double kMillisecondsPerSecond = 1e3;
constexpr char kGoneText[] = "no word from rgbdt sync live: see its terminal, or start it again";

}  // namespace

void WaveHistory::Add(const WaveProgress& progress, double now_s) {
  if (progress.phase < newest_.phase) *this = {};
  gone_ = false;
  if (!begun_ && progress.phase == WavePhase::kRecording) {
    begun_ = true;
    began_s_ = now_s;
  }
  newest_ = progress;
  heard_s_ = now_s;
  if (progress.phase != WavePhase::kRecording) return;
  Step step{static_cast<int>(std::lround(now_s - began_s_)), {}};
  for (const WavedClock& clock : progress.clocks) {
    if (clock.time_offset_s) step.sigmas[clock.camera] = clock.time_offset_s->sigma;
  }
  if (step.sigmas.empty()) return;
  if (!steps_.empty() && steps_.back().sigmas == step.sigmas) return;  // nothing new was solved
  if (!steps_.empty() && steps_.back().seconds >= step.seconds) steps_.pop_back();
  steps_.push_back(std::move(step));
  if (steps_.size() > kKept) steps_.pop_front();
}

bool WaveHistory::Update(double now_s) {
  if (heard_s_ == 0 || gone_ || IsOver(newest_.phase) || now_s - heard_s_ < kGone) return false;
  gone_ = true;
  return true;
}

nlohmann::json WaveHistory::Frame() const {
  nlohmann::json cameras = nlohmann::json::array();
  for (const WavedClock& clock : newest_.clocks) {
    nlohmann::json one = {{"camera", clock.camera},
                          {"offset_ms", nullptr},
                          {"sigma_ms", nullptr},
                          {"text", clock.text}};
    if (clock.time_offset_s) {
      one["offset_ms"] = kMillisecondsPerSecond * clock.time_offset_s->value;
      one["sigma_ms"] = kMillisecondsPerSecond * clock.time_offset_s->sigma;
    }
    cameras.push_back(std::move(one));
  }
  nlohmann::json steps = nlohmann::json::array();
  for (const Step& step : steps_) {
    nlohmann::json sigmas = nlohmann::json::array();
    for (const auto& [camera, sigma] : step.sigmas) {
      sigmas.push_back({{"camera", camera}, {"sigma_ms", kMillisecondsPerSecond * sigma}});
    }
    steps.push_back({{"seconds", step.seconds}, {"cameras", std::move(sigmas)}});
  }
  return {{"type", "wave"},
          {"phase", NameOf(gone_ ? WavePhase::kFailed : newest_.phase)},
          {"left_s", gone_ ? 0 : newest_.left_s},
          {"text", gone_ ? kGoneText : newest_.text},
          {"cameras", std::move(cameras)},
          {"steps", std::move(steps)}};
}

}  // namespace rgbdt::viewer
