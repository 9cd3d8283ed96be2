#include "calib/files/session/session_dir.h"

#include <algorithm>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> ListViews(const fs::path& folder) {
  std::vector<std::string> views;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.front() != '.' && it->is_directory(error)) views.push_back(name);
  }
  if (error) throw InputError("cannot list " + folder.string() + ": " + error.message());
  std::sort(views.begin(), views.end(), NaturalLess);
  return views;
}

}  // namespace

Session OpenSession(const fs::path& dir, LensNeed lenses) {
  if (!fs::is_directory(dir)) {
    throw InputError("there is no session directory " + dir.string() +
                     "; expected a folder with rig.textproto and views/");
  }
  const fs::path rig = dir / "rig.textproto";
  if (!fs::exists(rig)) {
    throw InputError(rig.string() +
                     " is missing; write one (cameras, lenses, board), as calib/files/README.md "
                     "shows");
  }
  Session session{dir, ReadRig(rig, lenses), {}};
  const fs::path views = dir / "views";
  if (fs::is_directory(views)) session.views = ListViews(views);
  if (session.views.empty()) {
    throw InputError(views.string() +
                     " holds no view; make a folder there for each view, with a view.textproto "
                     "that names its cloud and images");
  }
  return session;
}

void WriteRig(const fs::path& session_dir, const Rig& rig) {
  WriteFileAtomically(session_dir / "rig.textproto", rig.text.empty() ? PrintRig(rig) : rig.text);
}

}  // namespace rgbdt
