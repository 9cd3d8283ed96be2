#pragma once

#include <optional>
#include <string>

#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "services/foxglove/foxglove.pb.h"
#include "services/messages/bytes.h"

namespace rgbdt {

// What travels on the bus as Foxglove's messages. `frame`: the name of the frame that it is in.

google::protobuf::Timestamp ToTimestamp(Utime utime);

/// x y z [m], intensity, ring (65535: unknown), timestamp [s, UTC], of an organised sweep line and
/// beam; dir_x dir_y dir_z (unit, of each beam) and origin_x origin_y origin_z [m] where the sweep
/// has them. So a PCD of rgbdt names them, and `rgbdt import` gives the same sweep back. NaN: the
/// beam returned nothing. Its time is the sweep's.
foxglove::PointCloud ToFoxglove(const Cloud& sweep, const std::string& frame);

/// x y z [m]; red green blue alpha (alpha 0: no colour camera saw it); intensity; temperature and
/// temperature_sigma [K]; thermal_counts; valid (bit i: camera i saw it); timestamp [s, UTC]. Where
/// the rig's pose is known, the points' origin is in the frame "map" by it, else in `frame`.
foxglove::PointCloud ToFoxglove(const RgbdtCloud& cloud, const std::string& frame);

/// The pixels as they travelled: mono8, mono16, bgr8 or a mosaic (bayer_rggb8, ...).
foxglove::RawImage ToFoxglove(const Image& image, const std::string& frame);

/// A JPEG or PNG as it was sent.
struct ImageFile {
  Bytes bytes;
  Utime utime = 0;
};
foxglove::CompressedImage ToFoxglove(const ImageFile& file, const std::string& frame);

/// A camera's lens, by the models that it may have: plumb_bob, rational_polynomial, kannala_brandt.
foxglove::CameraCalibration ToFoxglove(const CameraSpec& camera, Utime utime,
                                       const std::string& frame);

/// parent_from_child, from `utime` on.
foxglove::FrameTransform ToFoxglove(const Rigid3& parent_from_child, const std::string& parent,
                                    const std::string& child, Utime utime);

/// Where the rig is, in the frame "map".
foxglove::PoseInFrame ToFoxglove(const StampedPose& pose);

/// A line of what a process says.
foxglove::Log ToLog(foxglove::Log::Level level, const std::string& process, const std::string& text,
                    Utime utime);

/// The frame of poses.
inline constexpr char kMapFrame[] = "map";

}  // namespace rgbdt
