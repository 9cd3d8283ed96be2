#include <algorithm>

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/own_folder.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/session.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"
#include "calib/model/unique_names.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// Names come from messages too: none may lead out of the session directory.
void CheckName(const std::string& name, const std::string& what) {
  const bool good = !name.empty() && name.size() <= 100 && name.front() != '.' &&
                    IsPrintable(name) && std::all_of(name.begin(), name.end(), [](char c) {
                      return c != '/' && static_cast<unsigned char>(c) > ' ';
                    });
  if (!good) {
    throw InputError(what + " \"" + PrintableText(name) +
                     "\" cannot be a file's name; expected letters, digits, _ and -");
  }
}

void FromRadiometry(const Radiometry& radiometry, proto::ViewImage* out) {
  if (radiometry.kind == Radiometry::Kind::kNone) return;
  if (radiometry.kind == Radiometry::Kind::kLinear) {
    text::FromLinear(radiometry, out->mutable_linear());
  } else {
    text::FromPlanck(radiometry, out->mutable_planck());
  }
  out->set_emissivity(radiometry.emissivity);
  out->set_reflected_temperature_k(radiometry.reflected_temperature_k);
}

void FromImage(const Image& image, const std::string& file, proto::ViewImage* out) {
  out->set_camera(ValidUtf8(image.camera));
  out->set_file(ValidUtf8(file));
  out->set_utime(image.utime);
  out->set_pixel_format(static_cast<proto::Camera::PixelFormat>(image.format));
  FromRadiometry(image.radiometry, out);
  out->set_exposure_s(image.exposure_s);
  out->set_frame_number(image.frame_number);
  out->set_device_utime(image.device_utime);
  out->set_shutter_correcting(image.shutter_correcting);
}

// The picks go to the image that they were made in.
void FromPicks(const View& view, const CornerSelection& picks, proto::View* out) {
  for (std::size_t i = 0; i < view.images.size(); ++i) {
    const Image& image = view.images[i];
    if (image.camera != picks.camera || image.utime != picks.image_utime) continue;
    proto::PickedCorners* picked = out->mutable_image(static_cast<int>(i))->mutable_picked();
    picked->clear_corner_px();
    for (const Eigen::Vector2d& corner : picks.corners) {
      picked->add_corner_px(corner.x());
      picked->add_corner_px(corner.y());
    }
    return;
  }
  throw InputError("view " + view.name + ": corners were picked in an image of camera \"" +
                   picks.camera + "\" of utime " + std::to_string(picks.image_utime) +
                   ", but the view has no such image");
}

// Of a link its own path: what it points at may be called otherwise. Protobuf and pages take UTF-8
// only.
std::string WholePath(const fs::path& path) {
  std::string whole = (fs::weakly_canonical(path.parent_path()) / path.filename()).string();
  if (!IsPrintable(whole)) {
    throw InputError(PrintableText(whole) +
                     ": its name has a control character or is not UTF-8; rename it");
  }
  return whole;
}

void WriteViewFile(const fs::path& folder, const proto::View& message) {
  WriteFileAtomically(folder / "view.textproto",
                      text::PrintText(message,
                                      "One view of the board (schema: "
                                      "calib/files/schema/session.proto). utime: us, UTC."));
}

}  // namespace

void WriteView(const fs::path& session_dir, const ViewFiles& view) {
  CheckName(view.name, "the view's name");
  proto::View message;
  message.set_cloud(WholePath(view.cloud));
  message.set_sweep_utime(view.sweep_utime);
  for (const ViewFiles::OfCamera& image : view.images) {
    proto::ViewImage* const out = message.add_image();
    out->set_camera(ValidUtf8(image.camera));
    out->set_file(WholePath(image.file));
    out->set_utime(image.utime);
  }
  for (const ViewFiles::OfLidar& further : view.further_clouds) {
    proto::FurtherCloud* const out = message.add_further_cloud();
    out->set_lidar(ValidUtf8(further.lidar));
    out->set_file(WholePath(further.file));
  }
  WriteViewFile(OwnFolder(OwnFolder(session_dir, "views"), view.name), message);
}

void WriteView(const fs::path& session_dir, const View& view) {
  CheckName(view.name, "the view's name");
  const fs::path folder = OwnFolder(OwnFolder(session_dir, "views"), view.name);
  proto::View message;
  message.set_cloud("cloud.pcd");
  message.set_sweep_utime(view.cloud.sweep_utime);
  message.set_heldout(view.heldout);
  if (view.map_from_lidar) text::FromRigid3(*view.map_from_lidar, message.mutable_map_from_lidar());
  UniqueNames names;  // rgb.png, and rgb_2.png for a second image of the camera
  for (const Image& image : view.images) {
    CheckName(image.camera, "view " + view.name + ": the camera's name");
    FromImage(image, names.Make(image.camera) + ".png", message.add_image());
  }
  for (const CornerSelection& picks : view.picks) FromPicks(view, picks, &message);
  for (const LidarCloud& further : view.further_clouds) {
    CheckName(further.lidar, "view " + view.name + ": the LIDAR's name");
    proto::FurtherCloud* out = message.add_further_cloud();
    out->set_lidar(ValidUtf8(further.lidar));
    out->set_file("cloud_" + ValidUtf8(further.lidar) + ".pcd");
  }

  std::error_code ignored;
  const bool is_new = !fs::exists(folder, ignored);
  const fs::path writes = is_new ? folder.parent_path() / ("." + view.name + ".part") : folder;
  try {
    if (is_new) fs::remove_all(writes, ignored);  // what a killed process left
    WritePcd(writes / "cloud.pcd", view.cloud);
    for (std::size_t i = 0; i < view.further_clouds.size(); ++i) {
      WritePcd(writes / message.further_cloud(static_cast<int>(i)).file(),
               view.further_clouds[i].cloud);
    }
    for (std::size_t i = 0; i < view.images.size(); ++i) {
      WritePng(writes / message.image(static_cast<int>(i)).file(), view.images[i].pixels);
    }
    WriteViewFile(writes, message);  // last: a folder with a view.textproto is complete
    if (is_new) Rename(writes, folder);
  } catch (...) {
    if (is_new) fs::remove_all(writes, ignored);
    throw;
  }
}

}  // namespace rgbdt
