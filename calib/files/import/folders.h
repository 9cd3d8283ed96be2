#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/files/import/lens_file.h"
#include "calib/files/import/pairing.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// What a person has: folders of images and clouds, lens files and a board.
struct Folders {
  struct Camera {
    std::string name;  ///< empty: "rgb" or "thermal", by its images
    std::filesystem::path images;
  };
  struct LensFile {
    std::string camera;  ///< empty: in the order of the cameras; one file may hold several
    std::filesystem::path file;
    std::string entry;  ///< the part of the file; empty: it tells itself
  };
  struct Lidar {
    std::string name;  ///< empty: "lidar", "lidar_2"
    std::filesystem::path clouds;
    /// Not empty: what the folder is to hold, of which `make` writes those that are in a view.
    std::vector<std::string> names{};
    std::function<void(const std::vector<std::string>&)> make{};
  };
  std::vector<Camera> cameras;
  std::vector<LensFile> lenses;
  std::vector<Lidar> lidars;  ///< the reference, to whose clouds all else is paired, and others
  Target board;
  std::optional<Lens::Model> model;  ///< of the lenses that no file says
  PairOptions pairing;
};

/// A session that names these files, and what a person is to know of how it was made.
struct FolderSession {
  Rig rig;
  std::vector<ViewFiles> views;
  std::vector<std::string> cameras;      ///< a line each: what its images and its lens are
  std::vector<std::string> left_over;    ///< a line for each reason: how many files, which, why
  PairedBy paired_by = PairedBy::kName;  ///< of the first camera

  /// The names of the cameras whose lens is still to be found.
  std::vector<std::string> WithoutLens() const;
};

/// Of camera `index` of those that are called `names`: from the file that is given for it, by its
/// name or, where files have none, in the cameras' order; one file may hold the lenses of all.
/// Nothing: none is for it. Throws InputError.
std::optional<FileLens> LensOf(const std::vector<Folders::LensFile>& lenses,
                               const std::vector<std::string>& names, std::size_t index,
                               std::optional<Lens::Model> model);

/// Throws InputError for lens files of cameras that are none of `names`, or for more than those.
void CheckLensFiles(const std::vector<Folders::LensFile>& lenses,
                    const std::vector<std::string>& names);

/// "pinhole" or "fisheye".
std::string NameOf(Lens::Model model);

/// Reads every image and every cloud once: what cannot be read is left over, and so is what has no
/// partner. A camera is thermal if its images have 16 bits, or one channel and "thermal" in its
/// name or its folder's. Throws InputError, one line: nothing pairs, images of several sizes in one
/// folder, a lens of another size or of a model that we do not have, clouds in millimetres.
FolderSession ReadFolders(const Folders& folders);

/// Throws InputError where `dir` holds a session already, or cannot be written.
void RequireRoomForSession(const std::filesystem::path& dir);

/// Writes the views and last rig.textproto, once RequireRoomForSession holds.
void WriteSession(const std::filesystem::path& dir, const FolderSession& session);

}  // namespace rgbdt
