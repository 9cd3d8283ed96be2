#include "calib/files/verdict.h"

#include <algorithm>

#include "calib/files/html.h"

namespace rgbdt {
namespace {

using Grade = Verdict::Grade;

constexpr std::size_t kFewViews = 5;
// Held-out views always fit a little worse; beyond this the solve has learnt its views by heart.
constexpr double kWorse = 1.5, kWorsePx = 0.5;
constexpr double kElsewhereDeg = 0.5, kElsewhereMm = 50;
constexpr double kClearlyWorse = 1.2;

class Judgement {
 public:
  void Say(const std::string& sentence) { verdict_.reasons.push_back(sentence); }
  void Caution(const std::string& sentence) {
    verdict_.grade = std::max(verdict_.grade, Grade::kCaution);
    Say(sentence);
  }
  void Bad(const std::string& sentence) {
    verdict_.grade = Grade::kBad;
    Say(sentence);
  }
  Verdict Finish() {
    verdict_.headline = verdict_.grade == Grade::kGood ? "Consistent: no sign that it is wrong."
                        : verdict_.grade == Grade::kCaution ? "Take care before using it."
                                                            : "Do not use it.";
    return verdict_;
  }

 private:
  Verdict verdict_;
};

void JudgeFit(const CameraReport& camera, Judgement* judgement) {
  const TrainHeldout& rms = camera.edge_rms_px;
  if (!rms.heldout) {
    judgement->Caution("It was not checked: no view that was kept from the solver could be used.");
    return;
  }
  const std::string held =
      "On views that the solver never saw, the board's outline is met within " +
      html::Number(*rms.heldout, 2) + " px RMS";
  if (!rms.train) {
    judgement->Say(held + ".");
  } else if (*rms.heldout > kWorse * *rms.train + kWorsePx) {
    judgement->Caution(held + ", clearly worse than the " + html::Number(*rms.train, 2) +
                       " px on the views used: take more views, at other distances and tilts.");
  } else {
    judgement->Say(held + ", as well as on the views used (" + html::Number(*rms.train, 2) +
                   " px).");
  }
}

std::string Count(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Another start that ended elsewhere and fits clearly worse is only a bad start.
bool FitsWorse(const StartResult& start, const CameraReport& camera) {
  const std::optional<double>& result = camera.distance_transform_px.train;
  return start.distance_transform_px && result &&
         *start.distance_transform_px > kClearlyWorse * *result;
}

void JudgeStarts(const CameraReport& camera, Judgement* judgement) {
  PoseError worst;
  std::size_t rivals = 0, stuck = 0;
  for (const StartResult& start : camera.other_starts) {
    const PoseError& error = start.from_result;
    if (error.rotation_deg <= kElsewhereDeg && error.translation_mm <= kElsewhereMm) continue;
    ++(FitsWorse(start, camera) ? stuck : rivals);
    worst.rotation_deg = std::max(worst.rotation_deg, error.rotation_deg);
    worst.translation_mm = std::max(worst.translation_mm, error.translation_mm);
  }
  if (camera.other_starts.empty()) return;
  const std::string of = " of " + Count(camera.other_starts.size(), "other start");
  const std::string away = "up to " + html::Number(worst.rotation_deg, 2) + "° and " +
                           html::Number(worst.translation_mm, 0) + " mm away";
  if (rivals > 0) {
    judgement->Caution(std::to_string(rivals) + of + " ended elsewhere, " + away +
                       ", and fits about as well: the result depends on the start.");
  } else if (stuck > 0) {
    judgement->Say(std::to_string(stuck) + of + " ended elsewhere, " + away +
                   ", and fits worse: the first guess has to be nearer than that.");
  } else {
    judgement->Say("From " + Count(camera.other_starts.size(), "other start") +
                   " it comes to the same result.");
  }
}

}  // namespace

Verdict Judge(const CameraReport& camera) {
  Judgement judgement;
  if (!camera.calibration.converged) {
    const std::string& status = camera.calibration.status;
    judgement.Bad("The solve did not converge" + (status.empty() ? "." : ": " + status));
  }
  JudgeFit(camera, &judgement);
  JudgeStarts(camera, &judgement);
  if (camera.used.size() < kFewViews) {
    judgement.Caution("Views used: only " + std::to_string(camera.used.size()) + "; take " +
                      std::to_string(kFewViews) + " or more.");
  }
  if (!camera.rejected.empty()) {
    judgement.Say("Rejected: " + Count(camera.rejected.size(), "view") +
                  "; why stands in the table of views.");
  }
  if (camera.truth_error) {
    judgement.Say("The truth is known here: the result is " +
                  html::Number(camera.truth_error->rotation_deg, 3) + "° and " +
                  html::Number(camera.truth_error->translation_mm, 1) + " mm away from it.");
  }
  return judgement.Finish();
}

}  // namespace rgbdt
