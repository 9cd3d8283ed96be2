#include "calib/files/session/session_dir.h"

#include <algorithm>
#include <map>
#include <utility>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// Reports and pages take nothing else, and a terminal would do what it says.
void RequireName(const fs::path& folder, const std::string& view) {
  if (IsPrintable(view)) return;
  throw InputError("the view \"" + PrintableText(view) + "\" in " + folder.string() +
                   " has a line break or another control character in its name, or bytes that are "
                   "no UTF-8; rename its folder");
}

std::vector<std::string> ListViews(const fs::path& folder) {
  std::vector<std::string> views;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.front() != '.' && it->is_directory(error)) views.push_back(name);
  }
  if (error) throw InputError("cannot list " + folder.string() + ": " + error.message());
  for (const std::string& view : views) RequireName(folder, view);
  std::sort(views.begin(), views.end(), NaturalLess);
  return views;
}

fs::path Whole(const Session& session) {
  fs::path path = fs::weakly_canonical(session.root);
  return path.has_filename() ? path : path.parent_path();
}

std::vector<std::string> NamesOf(const std::vector<Session>& sessions) {
  std::map<fs::path, int> paths;
  std::map<std::string, int> folders;
  for (const Session& session : sessions) {
    const fs::path path = Whole(session);
    ++folders[path.filename().string()];
    if (++paths[path] == 2) {
      throw InputError("the session " + session.root.string() + " is named twice");
    }
  }
  std::vector<std::string> names;
  for (const Session& session : sessions) {
    const std::string folder = Whole(session).filename().string();
    names.push_back(folders[folder] == 1 ? folder : Whole(session).string());
  }
  return names;
}

void AddPart(Session::Part part, Session* joined) {
  for (const std::string& view : part.session.views) {
    joined->views.push_back(part.name + "/" + view);
  }
  joined->parts.push_back(std::move(part));
}

void RequireSameRig(const Session& a, const Session& b) {
  const std::vector<std::string> differences = DifferencesOf(a.rig, b.rig);
  if (differences.empty()) return;
  throw InputError("the rigs of " + a.root.string() + " and " + b.root.string() +
                   " differ, so they cannot be solved together (" + InOneLine(differences) +
                   "): make the rig files agree, or calibrate each session by itself and use "
                   "`rgbdt compare`");
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

std::string Session::Title() const {
  if (parts.empty()) return root.lexically_normal().string();
  std::string title;
  for (const Part& part : parts) title += (title.empty() ? "" : ", ") + part.name;
  return title;
}

Session JoinSessions(std::vector<Session> sessions) {
  Session joined{{}, sessions.at(0).rig, {}};
  const std::vector<std::string> names = NamesOf(sessions);
  for (const Session& other : sessions) RequireSameRig(sessions[0], other);
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    AddPart({names[i], std::move(sessions[i])}, &joined);
  }
  return joined;
}

std::vector<Session> PartsOf(const Session& joined) {
  std::vector<Session> parts;
  for (const Session::Part& part : joined.parts) {
    AddPart(part, &parts.emplace_back(Session{{}, joined.rig, {}}));
  }
  return parts;
}

void WriteRig(const fs::path& session_dir, const Rig& rig) {
  WriteFileAtomically(session_dir / "rig.textproto", rig.text.empty() ? PrintRig(rig) : rig.text);
}

}  // namespace rgbdt
