#include "calib/fuse/sweep_fuser.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/fuse/internal/motion.h"

namespace rgbdt {
namespace {

void TransformPoints(const Rigid3& to_from, std::vector<Eigen::Vector3f>* points) {
  const Eigen::Matrix3f rotation = to_from.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = to_from.translation.cast<float>();
  for (Eigen::Vector3f& p : *points) p = rotation * p + translation;
}

}  // namespace

SweepFuser::SweepFuser(const std::vector<CameraSpec>& cameras, double range_sigma_m)
    : range_sigma_m_(range_sigma_m), seen_through_(range_sigma_m) {
  for (const CameraSpec& camera : cameras) states_.emplace_back(camera);
}

PoseTrack::Added SweepFuser::AddPose(const StampedPose& pose) {
  const auto added = poses_.Add(pose);
  // Nothing from before a jump has a known place any more; nor has what came before the first pose.
  if (added == PoseTrack::Added::kJump || !map_from_sweep_) Forget();
  return added;
}

void SweepFuser::Forget() {
  if (sweep_.empty() && past_points_.empty()) return;
  NextSweep();
  past_points_.clear();
  for (CameraState& state : states_) state.now = state.past = std::nullopt;
}

std::vector<RgbdtCloud> SweepFuser::SetCalibration(std::size_t camera,
                                                   const CameraCalibration& calibration,
                                                   Utime utime) {
  CameraState& state = states_[camera];
  if (state.camera.Has(calibration, utime)) return {};
  std::vector<RgbdtCloud> parts = Parts();
  state.camera.SetCalibration(calibration, utime);
  state.view = ViewBounds(state.camera.camera());
  state.spacing = PointSpacing(state.camera.camera());
  state.now = state.past = std::nullopt;  // made again by the next chunk, from the points kept
  return parts;
}

RgbdtCloud SweepFuser::FuseChunk(const Cloud& chunk) {
  Hits hits = HitsOf(chunk);
  counts_.points += static_cast<std::int64_t>(hits.size());
  if (!sweep_.empty() && sweep_utime_ != chunk.sweep_utime) NextSweep();  // end lost
  if (sweep_.empty() && !hits.empty()) BeginSweep(chunk.sweep_utime, hits);
  const bool placed = Place(&hits);
  if (!placed) counts_.without_pose += static_cast<std::int64_t>(hits.size());
  const BlockedPoints points(hits.points);
  for (CameraState& state : states_) {
    if (!placed || !state.camera.calibrated) continue;
    state.spacing.Add(chunk, state.camera.camera_from_lidar);
    SampleImages(hits, points, &state);
  }
  Blended blended = Blend(BlendCameras(), sweep_.size(), hits.size());
  counts_.coloured += blended.coloured;
  counts_.occluded += blended.occluded;
  const bool keeps = placed && !hits.empty();
  if (keeps) Keep(hits);
  RgbdtCloud fused = Fused(chunk.sweep_utime, std::move(hits), std::move(blended));
  if (keeps && map_from_sweep_) {
    fused.frame_utime = fused.utime.front();
    fused.map_from_lidar = poses_.At(fused.frame_utime);
    TransformPoints(fused.map_from_lidar->Inverse() * *map_from_sweep_, &fused.points);
  }
  return fused;
}

// What is published of points, in the frame that they are in.
RgbdtCloud SweepFuser::Fused(Utime sweep_utime, Hits hits, Blended blended) const {
  RgbdtCloud fused;
  fused.sweep_utime = sweep_utime;
  for (const CameraState& state : states_) {
    fused.cameras.push_back(state.camera.spec().name);
    fused.calibration_utime.push_back(state.camera.calibration_utime);
  }
  fused.points = std::move(hits.points);
  fused.intensity = std::move(hits.intensity);
  fused.utime = std::move(hits.utime);
  fused.rgb = std::move(blended.rgb);
  fused.temperature_k = std::move(blended.temperature_k);
  fused.temperature_sigma_k = std::move(blended.temperature_sigma_k);
  fused.thermal_counts = std::move(blended.thermal_counts);
  fused.valid = std::move(blended.valid);
  return fused;
}

void SweepFuser::BeginSweep(Utime sweep_utime, const Hits& hits) {
  sweep_utime_ = sweep_utime;
  frame_utime_ = hits.utime.front();
  moved_ = false;
  too_long_ = false;
  map_from_sweep_ = poses_.At(frame_utime_);
  if (!map_from_sweep_ || !map_from_past_) return;
  const Rigid3 past_from_sweep = map_from_past_->Inverse() * *map_from_sweep_;
  TransformPoints(past_from_sweep.Inverse(), &past_points_);
  for (CameraState& state : states_)
    state.camera_from_sweep = state.camera_from_sweep * past_from_sweep;
  map_from_past_ = map_from_sweep_;
}

// The sweep becomes the one before.
void SweepFuser::NextSweep() {
  std::swap(past_points_, sweep_.points);
  sweep_.Clear();
  map_from_past_ = map_from_sweep_;
  if (seen_points_ > 0) seen_through_.Clear();
  seen_points_ = 0;
  parted_ = 0;
  for (CameraState& state : states_) {
    state.seen.Clear();
    std::swap(state.past, state.now);
    if (!state.past) {
      state.now = std::nullopt;
    } else if (state.now) {
      state.now->Clear();  // its memory serves again
    }
  }
}

// From the frames of the points' own times to that of the sweep. False: not known.
bool SweepFuser::Place(Hits* hits) const {
  if (poses_.empty()) return true;
  if (!map_from_sweep_) return hits->empty();
  return PlaceInSweep(poses_, *map_from_sweep_, hits->utime, &hits->points);
}

std::optional<Rigid3> SweepFuser::CameraFromSweep(const FusionCamera& camera, Utime utime) const {
  if (!map_from_sweep_) return camera.camera_from_lidar;
  const auto map_from_lidar = poses_.At(utime);
  if (!map_from_lidar) return std::nullopt;
  return camera.camera_from_lidar * map_from_lidar->Inverse() * *map_from_sweep_;
}

// The points from `first` on that the same image serves, and where it was taken.
SweepFuser::Run SweepFuser::NextRun(const Hits& hits, std::size_t first,
                                    const CameraState& state) const {
  const Serving serving = state.camera.ServingAt(hits.utime[first]);
  Run run{first, first + 1, serving.image, state.camera_from_sweep};
  while (run.end < hits.size() && hits.utime[run.end] >= serving.from &&
         hits.utime[run.end] < serving.until) {
    ++run.end;
  }
  const Utime utime = run.image != nullptr ? state.camera.TakenAt(*run.image) : hits.utime[first];
  const auto camera_from_sweep = CameraFromSweep(state.camera, utime);
  if (camera_from_sweep) {
    run.camera_from_sweep = *camera_from_sweep;
  } else {
    run.image = nullptr;  // taken where nobody knows
  }
  return run;
}

PointProjector SweepFuser::ProjectorOf(const FusionCamera& camera, const Run& run) const {
  PointProjector projector(camera.camera(), run.camera_from_sweep);
  const double rolling_s = camera.spec().rolling_s;
  if (!map_from_sweep_ || run.image == nullptr || rolling_s == 0) return projector;
  const Utime half = FromSeconds(0.5 * rolling_s);
  const auto first = CameraFromSweep(camera, camera.TakenAt(*run.image) - half);
  const auto last = CameraFromSweep(camera, camera.TakenAt(*run.image) + half);
  if (first && last) {
    projector.SetMotion(Log(*last * first->Inverse()) / std::max(1, camera.spec().height - 1));
  }
  return projector;
}

// By more than a part of a cell, for what is 2 m away.
bool SweepFuser::HasMoved(const CameraState& state, const Rigid3& camera_from_sweep) const {
  constexpr double kNearM = 2;
  constexpr double kPart = 0.25;
  const double angle = RotationDistance(camera_from_sweep, state.camera_from_sweep) +
                       CentreDistance(camera_from_sweep, state.camera_from_sweep) / kNearM;
  const Lens& lens = state.camera.camera().lens();
  return angle * std::max(lens.fx, lens.fy) > kPart * state.cell_px.minCoeff();
}

// Sees to buffers that are made for this place. True: made anew, the chunk is not in them.
bool SweepFuser::PlaceBuffers(const Rigid3& camera_from_sweep, CameraState* state) {
  const bool any = state->now || state->past;
  const bool moved = any && HasMoved(*state, camera_from_sweep);
  if (any && !moved) {
    if (!state->now) state->now.emplace(state->camera.camera(), state->cell_px, range_sigma_m_);
    return false;
  }
  moved_ |= moved;
  if (!any) state->cell_px = state->spacing.CellPx();
  state->camera_from_sweep = camera_from_sweep;
  MakeBuffers(state);
  return true;
}

// What occludes things from state.camera_from_sweep, as far as kept points show it.
void SweepFuser::MakeBuffers(CameraState* state) const {
  const auto make = [&](const std::vector<Eigen::Vector3f>& points) {
    DepthBuffer buffer(state->camera.camera(), state->cell_px, range_sigma_m_);
    AddToBuffer(BlockedPoints(points), *state, &buffer);
    return buffer;
  };
  state->now.emplace(make(sweep_.points));
  state->past = std::nullopt;
  if (!past_points_.empty()) state->past.emplace(make(past_points_));
}

void SweepFuser::AddToBuffer(const BlockedPoints& points, const CameraState& state,
                             DepthBuffer* buffer) const {
  PointProjector(state.camera.camera(), state.camera_from_sweep)
      .ForBlocks(state.view, points, 0, points.size(),
                 [&](std::size_t, std::size_t count, const PixelBlock& block) {
                   buffer->Add(block, count);
                 });
  buffer->Close();
}

// What the images that serve the points show of them, and what occludes it.
void SweepFuser::SampleImages(const Hits& hits, const BlockedPoints& points, CameraState* state) {
  const std::size_t before_chunk = state->seen.size();
  for (std::size_t first = 0; first < hits.size();) {
    const Run run = NextRun(hits, first, *state);
    const bool anew = PlaceBuffers(run.camera_from_sweep, state);
    // While nothing moves, what is looked at goes into the buffer on the way.
    const bool still = !map_from_sweep_;
    if (!still && (anew || first == 0)) AddToBuffer(points, *state, &*state->now);
    const std::size_t before_run = state->seen.size();
    SampleRun(points, run, still, state);
    if (!still) TestOcclusionFrom(hits, before_run, state);
    first = run.end;
  }
  if (map_from_sweep_ || hits.size() == 0) return;
  state->now->Close();
  TestOcclusionFrom(hits, before_chunk, state);
}

void SweepFuser::SampleRun(const BlockedPoints& points, const Run& run, bool add,
                           CameraState* state) {
  if (run.image == nullptr) counts_.without_image += static_cast<std::int64_t>(run.end - run.first);
  ProjectorOf(state->camera, run)
      .ForBlocks(state->view, points, run.first, run.end,
                 [&](std::size_t first, std::size_t count, const PixelBlock& block) {
                   if (add) state->now->Add(block, count);
                   if (run.image == nullptr) return;
                   SampleImage(state->camera, *run.image, block, sweep_.size() + first, count,
                               &state->seen);
                 });
}

void SweepFuser::TestOcclusionFrom(const Hits& hits, std::size_t first, CameraState* state) {
  PointSamples& seen = state->seen;
  TestOcclusion(*state->now, state->past ? &*state->past : nullptr, first, &seen);
  if (!state->past || map_from_sweep_) return;
  const auto next_occluded = [&seen](std::size_t from) {
    const auto begin = seen.occluded.begin();
    return static_cast<std::size_t>(
        std::find(begin + static_cast<std::ptrdiff_t>(from), seen.occluded.end(), 1) - begin);
  };
  for (std::size_t i = next_occluded(first); i < seen.size(); i = next_occluded(i + 1)) {
    if (state->now->Occludes(seen.u[i], seen.v[i], seen.inverse_range[i])) continue;
    UpdateSeenThrough(hits);
    if (IsGone(*state, hits.points[seen.point[i] - sweep_.size()], i)) seen.occluded[i] = 0;
  }
}

// Only where it is asked for.
void SweepFuser::UpdateSeenThrough(const Hits& hits) {
  const std::size_t all = sweep_.size() + hits.size();
  if (seen_points_ == all) return;
  seen_through_.Add(sweep_.points, std::min(seen_points_, sweep_.size()));
  seen_through_.Add(hits.points);
  seen_points_ = all;
}

// Whether what the sweep before saw in front of a point is there no more.
bool SweepFuser::IsGone(const CameraState& state, const Eigen::Vector3f& point,
                        std::size_t sample) const {
  const PointSamples& seen = state.seen;
  const float surface = state.past->SurfaceAt(seen.u[sample], seen.v[sample]);
  const Eigen::Vector3f centre = state.camera_from_sweep.Inverse().translation.cast<float>();
  return seen_through_.IsGone(centre + seen.inverse_range[sample] / surface * (point - centre));
}

std::vector<BlendCamera> SweepFuser::BlendCameras() const {
  std::vector<BlendCamera> cameras;
  for (const CameraState& state : states_) {
    cameras.push_back({&state.camera, &state.seen, state.now ? &*state.now : nullptr});
  }
  return cameras;
}

void SweepFuser::Keep(const Hits& hits) {
  if (too_long_ || sweep_.size() + hits.size() > kMaxSweepPoints) {
    too_long_ = true;
    for (CameraState& state : states_) state.seen.CutBack(state.seen.FirstFrom(sweep_.size()));
    return;
  }
  sweep_.Append(hits);
}

// Cells that suit the points' spacing as the whole sweep shows it: a first line alone does not.
void SweepFuser::FitCells() {
  constexpr double kEnough = 1.15;
  for (CameraState& state : states_) {
    if (!state.now) continue;
    const Eigen::Vector2d cell = state.spacing.CellPx();
    const Eigen::Array2d ratio = cell.array() / state.cell_px.array();
    if (ratio.maxCoeff() < kEnough && ratio.minCoeff() > 1 / kEnough) continue;
    state.cell_px = cell;
    MakeBuffers(&state);
  }
}

RgbdtCloud SweepFuser::Part(std::size_t first, std::size_t end) const {
  RgbdtCloud part =
      Fused(sweep_utime_, sweep_.Part(first, end), Blend(BlendCameras(), first, end - first));
  part.whole_sweep = true;
  part.map_from_lidar = map_from_sweep_;
  part.frame_utime = map_from_sweep_ ? frame_utime_ : 0;
  return part;
}

// What was kept since the last parts.
std::vector<RgbdtCloud> SweepFuser::Parts() {
  for (CameraState& state : states_) {
    if (moved_ || !state.now) continue;
    TestOcclusion(*state.now, nullptr, state.seen.FirstFrom(parted_), &state.seen);
  }
  std::vector<RgbdtCloud> parts;
  for (; parted_ < sweep_.size(); parted_ += parts.back().size()) {
    parts.push_back(Part(parted_, std::min(sweep_.size(), parted_ + kPartPoints)));
  }
  return parts;
}

std::vector<RgbdtCloud> SweepFuser::EndSweep() {
  FitCells();
  std::vector<RgbdtCloud> parts;
  if (!too_long_) parts = Parts();
  if (!parts.empty()) parts.back().sweep_end = true;
  NextSweep();
  return parts;
}

}  // namespace rgbdt
