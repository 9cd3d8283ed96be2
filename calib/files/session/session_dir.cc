#include "calib/files/session/session_dir.h"

#include <algorithm>
#include <cctype>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// The digits from `at` on without leading zeros; moves `at` behind them.
std::string TakeNumber(const std::string& text, std::size_t* at) {
  while (*at < text.size() && text[*at] == '0') ++*at;
  const std::size_t begin = *at;
  while (*at < text.size() && IsDigit(text[*at])) ++*at;
  return text.substr(begin, *at - begin);
}

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

bool NaturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string x = TakeNumber(a, &i), y = TakeNumber(b, &j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (i == a.size() && j == b.size()) return a < b;  // "1" and "01": any order, but one
  return i == a.size();
}

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
