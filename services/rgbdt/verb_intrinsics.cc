#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "calib/camera/intrinsics.h"
#include "calib/camera/lens_choice.h"
#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/schema/rig_file.h"
#include "calib/methods/session_corners.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/present/report/intrinsics_html.h"
#include "calib/present/report/intrinsics_text.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, LensChoice> kChoices = {{"pinhole5", LensChoice::kPinhole5},
                                                    {"pinhole8", LensChoice::kPinhole8},
                                                    {"fisheye", LensChoice::kFisheye}};

struct IntrinsicsFlags {
  std::string dir, out;
  std::vector<std::string> cameras;
  std::optional<LensChoice> choice;
};

// What was asked for, or else what the rig file's lens is.
LensChoice ChoiceFor(const IntrinsicsFlags& flags, const Lens& lens) {
  if (flags.choice) return *flags.choice;
  if (lens.model == Lens::Model::kFisheye) return LensChoice::kFisheye;
  const bool rational = std::any_of(lens.distortion.begin() + 5, lens.distortion.end(),
                                    [](double k) { return k != 0; });
  return rational ? LensChoice::kPinhole8 : LensChoice::kPinhole5;
}

std::vector<std::string> CamerasFor(const IntrinsicsFlags& flags, const Rig& rig) {
  for (const std::string& name : flags.cameras) rig.Camera(name);
  if (!flags.cameras.empty()) return flags.cameras;
  std::vector<std::string> all;
  for (const CameraSpec& camera : rig.cameras) all.push_back(camera.name);
  return all;
}

IntrinsicsInput InputOf(const IntrinsicsFlags& flags, const Rig& rig,
                        const CameraCorners& corners) {
  const CameraSpec& camera = rig.Camera(corners.camera);
  return {ChoiceFor(flags, camera.lens), camera.width, camera.height, rig.target, corners.views};
}

// A camera without a single image is left as it is, unless it was asked for by name.
bool IsSkipped(const IntrinsicsFlags& flags, const CameraCorners& corners) {
  if (corners.images > 0 || !flags.cameras.empty()) return false;
  std::printf("camera %s: the session has no image of it; left as it is\n", corners.camera.c_str());
  return true;
}

void WriteIntrinsics(const fs::path& out, const Session& session, const Rig& rig,
                     const std::vector<CameraIntrinsics>& solved) {
  const fs::path page = out.parent_path() / "intrinsics.html";
  WriteFileAtomically(page, IntrinsicsHtml(solved));
  std::printf("wrote %s", page.c_str());
  const bool any = std::any_of(solved.begin(), solved.end(), [](const CameraIntrinsics& camera) {
    return camera.result.converged;
  });
  if (!any) {
    std::printf("; no camera converged: no rig file was written\n");
    return;
  }
  WriteFileAtomically(out, PrintRig(rig));
  std::printf(" and %s: the rig with the lenses found (comments of the old file are not kept)\n",
              out.c_str());
  const fs::path in_use = session.root / "rig.textproto";
  if (fs::weakly_canonical(out) != fs::weakly_canonical(in_use)) {
    std::printf("next: mv %s %s && rgbdt calibrate %s\n", ForShell(out).c_str(),
                ForShell(in_use).c_str(), ForShell(session.root).c_str());
  }
}

int RunIntrinsics(const IntrinsicsFlags& flags) {
  const Session session = OpenSession(flags.dir, LensNeed::kMayBeUnknown);
  const fs::path out = PathOr(flags.out, session.root / "rig.intrinsics.textproto");
  CheckWritable(out);
  const SessionCorners corners =
      FindSessionCorners(session, CamerasFor(flags, session.rig), PrintProgress);
  RequireReadable(session, corners.unreadable);
  Rig rig = session.rig;
  std::vector<CameraIntrinsics> solved;
  bool good = corners.unreadable.empty();
  for (const CameraCorners& camera : corners.cameras) {
    if (IsSkipped(flags, camera)) continue;
    const CameraSpec& before = session.rig.Camera(camera.camera);
    const IntrinsicsInput input = InputOf(flags, session.rig, camera);
    const CameraIntrinsics& found =
        solved.emplace_back(CameraIntrinsics{before, camera, CalibrateIntrinsics(input)});
    std::printf("%s%s\n", IntrinsicsText(found).c_str(),
                LensComparisonText(CompareLenses(input, found.result)).c_str());
    good &= found.result.converged;
    for (CameraSpec& spec : rig.cameras) {
      if (spec.name != camera.camera || !found.result.converged) continue;
      spec.lens = found.result.lens;
      spec.lens_uncertainty.reset();
      if (found.result.covariance.size() > 0) {
        spec.lens_uncertainty = UncertaintyOf(found.result, camera.views);
      }
    }
  }
  PrintUnreadable(corners.unreadable);
  if (solved.empty()) throw InputError(flags.dir + " holds no image of any camera of its rig");
  WriteIntrinsics(out, session, rig, solved);
  return EndsWith(good);
}

}  // namespace

bool FindLenses(const std::string& session_dir, const std::vector<std::string>& cameras) {
  IntrinsicsFlags flags;
  flags.dir = session_dir;
  flags.out = (fs::path(session_dir) / "rig.textproto").string();
  flags.cameras = cameras;
  return RunIntrinsics(flags) == 0;
}

void AddIntrinsics(CommandLine* program) {
  auto flags = std::make_shared<IntrinsicsFlags>();
  CommandLine* verb = program->Verb(
      "intrinsics",
      "Finds the cameras' lenses from the checkerboard in a session's images; clouds are not\n"
      "needed, and the rig file may lack the lenses. 20 views or more, tilted by 30 to 45 "
      "degrees,\n"
      "in every part of the image. Writes the rig with the lenses, and intrinsics.html beside it.\n"
      "Example: rgbdt intrinsics out/lenses --camera rgb --model pinhole5",
      [flags] { return RunIntrinsics(*flags); });
  verb->Ends(ExitCode::kFailed, "failed, a camera did not converge, or a view could not be read");
  verb->Required("DIR", &flags->dir, "session directory (rig.textproto, views/)");
  verb->Option("--camera", &flags->cameras, "only this one; may be given again");
  verb->Choice("--model", &flags->choice, kChoices,
               "with 5 or 8 numbers of distortion, or OpenCV's fisheye; default: the rig file's,\n"
               "else pinhole5. The other models are tried on the same images, and one that these\n"
               "want is named");
  verb->Option("--out", &flags->out,
               "the rig file to write; default: DIR/rig.intrinsics.textproto, so that the rig\n"
               "file in use is not replaced");
}

}  // namespace rgbdt
