#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/fuse/blend.h"
#include "calib/fuse/hits.h"
#include "calib/fuse/point_spacing.h"
#include "calib/fuse/seen_through.h"
#include "calib/model/cloud.h"
#include "calib/model/pose_track.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// What happened to points since the start.
struct FusionCounts {
  std::int64_t points = 0;
  std::int64_t coloured = 0;  ///< seen by at least one camera
  std::int64_t occluded = 0;  ///< by camera: in its image, but behind something
  std::int64_t without_image =
      0;  ///< by camera: calibrated, but without an image of the point's time
  std::int64_t without_pose = 0;  ///< the pose stream does not tell where the rig was
};

/// Colours a cloud that comes in chunks, as it comes, and each sweep once more at its end.
///
/// Each hit is projected into the image of each camera that serves its time (FusionCamera), through
/// the full lens model, and sampled bilinearly; it is coloured where no point of this sweep so far
/// or of the sweep before occludes it (DepthBuffer); while the rig stands, what this sweep has
/// seen through is taken for gone (SeenThrough). At a sweep's end all of its points are tested for
/// occlusion by the whole sweep: what occludes a point may have come after it.
///
/// While poses come (AddPose) the rig's motion is compensated: all points of a chunk are in the
/// LIDAR frame of its first one's time, all points of a sweep in that of its own first, and images
/// are looked at from where they were taken, row by row where the camera rolls
/// (CameraSpec::rolling_s). Points of times that the poses do not tell stay uncoloured, in the
/// frame of their own time. While the rig moves, a sweep's end keeps what its chunks were found to
/// be.
class SweepFuser {
 public:
  /// Points of a sweep that are kept until its end; longer ones have none.
  static constexpr std::size_t kMaxSweepPoints = 2'000'000;
  /// Points in one message.
  static constexpr std::size_t kPartPoints = 40'000;

  /// `range_sigma_m`: noise of the LIDAR's ranges.
  SweepFuser(const std::vector<CameraSpec>& cameras, double range_sigma_m);

  std::size_t cameras() const { return states_.size(); }
  FusionCamera& camera(std::size_t index) { return states_[index].camera; }
  const FusionCamera& camera(std::size_t index) const { return states_[index].camera; }
  const FusionCounts& counts() const { return counts_; }

  PoseTrack::Added AddPose(const StampedPose& pose);

  /// From the next chunk on. What the sweep has so far is tested for occlusion and given back as if
  /// it ended here: no message mixes two calibrations.
  std::vector<RgbdtCloud> SetCalibration(std::size_t camera, const CameraCalibration& calibration,
                                         Utime utime);

  /// A chunk of a sweep, coloured at once; in the order of its points, misses left out.
  RgbdtCloud FuseChunk(const Cloud& chunk);

  /// The sweep's points, tested for occlusion as a whole, in messages of kPartPoints; the last has
  /// sweep_end.
  std::vector<RgbdtCloud> EndSweep();

 private:
  // What a camera sees, and what occludes things from it.
  struct CameraState {
    explicit CameraState(const CameraSpec& spec)
        : camera(spec), view(camera.camera()), spacing(camera.camera()) {}
    FusionCamera camera;
    ViewBounds view;
    PointSpacing spacing;
    std::optional<DepthBuffer> now, past;  // of this sweep, of the one before
    Rigid3 camera_from_sweep;              // where they were made for
    Eigen::Vector2d cell_px{0, 0};         // theirs
    PointSamples seen;                     // of the sweep; points numbered as it numbers them
  };
  // Points of the chunk that one image serves; or none.
  struct Run {
    std::size_t first = 0, end = 0;
    const PreparedImage* image = nullptr;
    Rigid3 camera_from_sweep;
  };

  void BeginSweep(Utime sweep_utime, const Hits& hits);
  void NextSweep();
  void Forget();
  bool Place(Hits* hits) const;
  void SampleImages(const Hits& hits, const BlockedPoints& points, CameraState* state);
  void SampleRun(const BlockedPoints& points, const Run& run, bool add, CameraState* state);
  void TestOcclusionFrom(const Hits& hits, std::size_t first, CameraState* state);
  void UpdateSeenThrough(const Hits& hits);
  bool IsGone(const CameraState& state, const Eigen::Vector3f& point, std::size_t sample) const;
  Run NextRun(const Hits& hits, std::size_t first, const CameraState& state) const;
  std::optional<Rigid3> CameraFromSweep(const FusionCamera& camera, Utime utime) const;
  PointProjector ProjectorOf(const FusionCamera& camera, const Run& run) const;
  bool HasMoved(const CameraState& state, const Rigid3& camera_from_sweep) const;
  bool PlaceBuffers(const Rigid3& camera_from_sweep, CameraState* state);
  void MakeBuffers(CameraState* state) const;
  void AddToBuffer(const BlockedPoints& points, const CameraState& state,
                   DepthBuffer* buffer) const;
  void FitCells();
  void Keep(const Hits& hits);
  std::vector<RgbdtCloud> Parts();
  RgbdtCloud Part(std::size_t first, std::size_t end) const;
  RgbdtCloud Fused(Utime sweep_utime, Hits hits, Blended blended) const;
  std::vector<BlendCamera> BlendCameras() const;

  std::vector<CameraState> states_;
  double range_sigma_m_;
  FusionCounts counts_;
  PoseTrack poses_;

  // The sweep so far, in its own frame; colours are not kept but made at its end.
  Hits sweep_;
  Utime sweep_utime_ = 0;
  Utime frame_utime_ = 0;                 // that its frame is the LIDAR's of
  std::size_t parted_ = 0;                // points of it that Parts() gave back before its end
  std::optional<Rigid3> map_from_sweep_;  // nothing: no pose stream
  bool moved_ = false;                    // a camera did, within the sweep
  bool too_long_ = false;
  std::vector<Eigen::Vector3f> past_points_;
  SeenThrough seen_through_;     // by this sweep
  std::size_t seen_points_ = 0;  // so many of it and the chunk
  std::optional<Rigid3> map_from_past_;
};

}  // namespace rgbdt
