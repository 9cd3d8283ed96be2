// Which lens file is which camera's.
#include <algorithm>

#include "calib/files/import/folders.h"
#include "calib/files/import/lens_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// The file for camera `index` of those that are called `names`; none: it has none.
const Folders::LensFile* LensFor(const std::vector<Folders::LensFile>& lenses,
                                 const std::vector<std::string>& names, std::size_t index) {
  const auto by_name = [&](const std::string& name) -> const Folders::LensFile* {
    for (const Folders::LensFile& lens : lenses) {
      if (lens.camera == name) return &lens;
    }
    return nullptr;
  };
  if (const Folders::LensFile* lens = by_name(names[index])) return lens;
  std::vector<const Folders::LensFile*> in_order;
  for (const Folders::LensFile& lens : lenses) {
    if (lens.camera.empty()) in_order.push_back(&lens);
  }
  const auto before = static_cast<std::size_t>(
      std::count_if(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(index),
                    [&](const std::string& name) { return by_name(name) == nullptr; }));
  if (before < in_order.size()) return in_order[before];
  return in_order.size() == 1 ? in_order[0] : nullptr;  // one file may be all cameras'
}

}  // namespace

std::string NameOf(Lens::Model model) {
  return model == Lens::Model::kFisheye ? "fisheye" : "pinhole";
}

std::optional<FileLens> LensOf(const std::vector<Folders::LensFile>& lenses,
                               const std::vector<std::string>& names, std::size_t index,
                               std::optional<Lens::Model> model) {
  const Folders::LensFile* file = LensFor(lenses, names, index);
  if (file == nullptr) return std::nullopt;
  FileLens found = ReadLensFile({file->file, file->entry, names[index], static_cast<int>(index),
                                 static_cast<int>(names.size()), model});
  const bool first_ones =
      file->camera.empty() && lenses.size() < names.size() && index > 0 && found.parts == 1;
  if (first_ones) return std::nullopt;
  return found;
}

void CheckLensFiles(const std::vector<Folders::LensFile>& lenses,
                    const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  for (const Folders::LensFile& lens : lenses) {
    if (lens.camera.empty() || std::count(names.begin(), names.end(), lens.camera) > 0) continue;
    throw InputError("--lens is given for camera \"" + lens.camera + "\"; the cameras are " + list);
  }
  if (lenses.size() > names.size()) {
    throw InputError(std::to_string(lenses.size()) + " lens files are given for " +
                     std::to_string(names.size()) +
                     (names.size() == 1 ? " camera (" : " cameras (") + list +
                     "); expected one for each");
  }
}

}  // namespace rgbdt
