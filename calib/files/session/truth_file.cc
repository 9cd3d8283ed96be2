#include "calib/files/atomic_file.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/session.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/text.h"

namespace rgbdt {

using text::Place;

Truth ReadTruth(const std::filesystem::path& path) {
  proto::Truth message;
  Place::Tree tree;
  const Place place = text::ParseText(ReadWholeFile(path), path.string(), &message, &tree);
  Truth truth;
  for (int i = 0; i < message.camera_size(); ++i) {
    const proto::TruthCamera& camera = message.camera(i);
    truth.camera_from_lidar[camera.camera()] =
        text::ToRigid3(camera.camera_from_lidar(), place.In("camera", i).In("camera_from_lidar"));
  }
  for (int i = 0; i < message.view_size(); ++i) {
    const proto::TruthView& view = message.view(i);
    truth.lidar_from_target[view.view()] =
        text::ToRigid3(view.lidar_from_target(), place.In("view", i).In("lidar_from_target"));
  }
  for (int i = 0; i < message.lidar_size(); ++i) {
    const proto::TruthLidar& lidar = message.lidar(i);
    truth.reference_from_lidar[lidar.lidar()] = text::ToRigid3(
        lidar.reference_from_lidar(), place.In("lidar", i).In("reference_from_lidar"));
  }
  if (truth.camera_from_lidar.empty()) {
    place.Fail("camera", "is missing; expected camera { camera: NAME camera_from_lidar { ... } }");
  }
  return truth;
}

void WriteTruth(const std::filesystem::path& path, const Truth& truth, const std::string& remark) {
  proto::Truth message;
  for (const auto& [name, camera_from_lidar] : truth.camera_from_lidar) {
    proto::TruthCamera* camera = message.add_camera();
    camera->set_camera(ValidUtf8(name));
    text::FromRigid3(camera_from_lidar, camera->mutable_camera_from_lidar());
  }
  for (const auto& [name, lidar_from_target] : truth.lidar_from_target) {
    proto::TruthView* view = message.add_view();
    view->set_view(ValidUtf8(name));
    text::FromRigid3(lidar_from_target, view->mutable_lidar_from_target());
  }
  for (const auto& [name, reference_from_lidar] : truth.reference_from_lidar) {
    proto::TruthLidar* lidar = message.add_lidar();
    lidar->set_lidar(ValidUtf8(name));
    text::FromRigid3(reference_from_lidar, lidar->mutable_reference_from_lidar());
  }
  WriteFileAtomically(
      path, text::PrintText(message,
                            "What only a simulator knows; read by `rgbdt evaluate --truth`.\n"
                            "point_in_camera = camera_from_lidar * point_in_lidar, "
                            "point_in_lidar = lidar_from_target * point_in_target\n" +
                                remark));
}

}  // namespace rgbdt
