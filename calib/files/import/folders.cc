#include "calib/files/import/folders.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "calib/files/check_writable.h"
#include "calib/files/import/camera_kind.h"
#include "calib/files/import/internal/folder_files.h"
#include "calib/files/import/internal/view_names.h"
#include "calib/files/import/lens_file.h"
#include "calib/files/name_keys.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/statistics.h"
#include "calib/model/unique_names.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// A camera's folder once it was read.
struct ReadCamera {
  FileList images;
  Pairs pairs;
  std::set<std::size_t> unreadable, without;  // images, and the clouds that had them
  CameraSpec spec;
  bool turned_by_exif = false;
  std::string why;  // it is of its kind; empty: there is nothing to say
};

std::string SizeOf(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

// "a.png, b.png, c.png and 12 more"
std::string Some(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  return names.size() <= kMost ? text
                               : text + " and " + std::to_string(names.size() - kMost) + " more";
}

std::string Counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// The size that most of those that can be read have, if three in four have it.
std::optional<std::pair<int, int>> UsualSize(const std::vector<ImageFacts>& facts) {
  std::map<std::pair<int, int>, std::size_t> counts;
  std::size_t all = 0;
  for (const ImageFacts& one : facts) {
    if (!one.problem.empty()) continue;
    ++counts[{one.width, one.height}];
    ++all;
  }
  for (const auto& [size, count] : counts) {
    if (4 * count >= 3 * all) return size;
  }
  return std::nullopt;
}

// Takes the pairs apart whose image cannot be read, or is of another size than the rest; gives the
// others' facts.
std::vector<ImageFacts> DropUnreadable(ReadCamera* camera, std::vector<std::string>* left_over) {
  std::vector<std::size_t> paired;
  for (std::size_t i = 0; i < camera->images.names.size(); ++i) {
    if (camera->pairs.cloud_of[i]) paired.push_back(i);
  }
  std::vector<ImageFacts> facts = LookAtImages(camera->images, paired);
  const auto usual = UsualSize(facts);
  for (std::size_t k = 0; usual && k < facts.size(); ++k) {
    ImageFacts& one = facts[k];
    if (!one.problem.empty() || std::pair(one.width, one.height) == *usual) continue;
    one.problem = (camera->images.folder / camera->images.names[paired[k]]).string() + " is " +
                  SizeOf(one.width, one.height) + ", where the others are " +
                  SizeOf(usual->first, usual->second);
  }
  std::vector<ImageFacts> good;
  std::string problem;
  for (std::size_t k = 0; k < facts.size(); ++k) {
    if (facts[k].problem.empty()) {
      good.push_back(facts[k]);
      continue;
    }
    problem = facts[k].problem;
    left_over->push_back(problem);
    camera->without.insert(*camera->pairs.cloud_of[paired[k]]);
    camera->pairs.cloud_of[paired[k]].reset();
    camera->unreadable.insert(paired[k]);
  }
  if (good.empty()) {
    throw InputError("no image of " + camera->images.folder.string() + " can be used: " + problem);
  }
  return good;
}

bool IsSixteenBit(const ImageFacts& facts) { return facts.format == PixelFormat::kMono16; }

void CheckAlike(const FileList& files, const std::vector<ImageFacts>& facts) {
  for (const ImageFacts& other : facts) {
    const ImageFacts& first = facts[0];
    if (other.width != first.width || other.height != first.height) {
      throw InputError("the images of " + files.folder.string() + " are of several sizes (" +
                       SizeOf(first.width, first.height) + ", " +
                       SizeOf(other.width, other.height) +
                       "); expected those of one camera in a folder");
    }
    if (IsSixteenBit(other) != IsSixteenBit(first)) {
      throw InputError("the images of " + files.folder.string() +
                       " have 8 bits and 16; expected those of one camera in a folder");
    }
  }
}

std::string LastName(const fs::path& folder) {
  const fs::path whole = fs::weakly_canonical(folder);
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

// Gives what there is to say of it in `why`.
CameraKind KindOf(const Folders::Camera& camera, const std::vector<ImageFacts>& all,
                  std::string* why) {
  const ImageFacts& facts = all[0];
  const std::string name = camera.name.empty() ? LastName(camera.images) : camera.name;
  if (IsSixteenBit(facts)) {
    std::vector<double> parts;
    for (const ImageFacts& one : all) parts.push_back(one.dark_over_bright);
    const auto [kind, by] = KindOfSixteenBit({name, LastName(camera.images)}, Median(parts));
    if (!by.empty()) {
      *why = by + "; otherwise say --images " +
             (kind == CameraKind::kThermal ? "rgb=" : "thermal=") + camera.images.string();
    }
    return kind;
  }
  if (!SaysThermal(name, false)) return CameraKind::kColor;
  if (!facts.grey) {
    throw InputError("\"" + name + "\" is a thermal camera's name, but the images of " +
                     camera.images.string() +
                     " have 3 channels: give its raw counts (one channel, 16 or 8 bit), not a "
                     "coloured picture of them");
  }
  return CameraKind::kThermal;
}

[[noreturn]] void RefuseWithoutLens(const std::string& camera) {
  throw InputError("camera \"" + camera +
                   "\" has no lens: give --lens FILE, or say --pinhole or --fisheye and it is "
                   "found from the images");
}

// Sets the lens, or the model that is wanted; gives what there is to say of it.
std::string SetLens(const Folders& folders, const std::vector<std::string>& names,
                    std::size_t index, CameraSpec* spec) {
  if (const auto found = LensOf(folders.lenses, names, index, folders.model)) {
    CheckLensSize(*found, spec->name, spec->width, spec->height);
    spec->lens = found->lens;
    return NameOf(spec->lens.model) + " lens of " + found->where;
  }
  if (!folders.model) RefuseWithoutLens(spec->name);
  if (!folders.board.HasPattern()) {
    throw InputError("camera \"" + spec->name +
                     "\" has no lens, and a plain board has no corners to find it from: give "
                     "--lens FILE");
  }
  spec->lens.model = *folders.model;
  return NameOf(spec->lens.model) + " lens, not known yet";
}

ReadCamera ReadOne(const Folders& folders, const Folders::Camera& camera, const FileList& clouds,
                   UniqueNames* names, std::vector<std::string>* left_over) {
  ReadCamera read;
  read.images = ListImages(camera.images);
  read.pairs = PairFiles(read.images, clouds, folders.pairing);
  const std::vector<ImageFacts> facts = DropUnreadable(&read, left_over);
  CheckAlike(read.images, facts);
  CameraSpec& spec = read.spec;
  spec.kind = KindOf(camera, facts, &read.why);
  const bool thermal = spec.kind == CameraKind::kThermal;
  spec.name = camera.name.empty() ? names->Make(thermal ? "thermal" : "rgb") : camera.name;
  names->Insert(spec.name);
  spec.width = facts[0].width;
  spec.height = facts[0].height;
  const bool reduced = IsSixteenBit(facts[0]) && !thermal;
  spec.format = reduced ? PixelFormat::kMono8 : facts[0].format;
  if (thermal && spec.format == PixelFormat::kBgr8) spec.format = PixelFormat::kMono8;
  read.turned_by_exif = std::any_of(facts.begin(), facts.end(),
                                    [](const ImageFacts& one) { return one.turned_by_exif; });
  return read;
}

// A line each of what they are.
std::vector<std::string> SetLenses(const Folders& folders, std::vector<ReadCamera>* cameras) {
  std::vector<std::string> names, lines;
  for (const ReadCamera& camera : *cameras) names.push_back(camera.spec.name);
  CheckLensFiles(folders.lenses, names);
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    CameraSpec& spec = (*cameras)[i].spec;
    const std::string lens = SetLens(folders, names, i, &spec);
    lines.push_back("camera " + spec.name + ": " +
                    (spec.kind == CameraKind::kThermal ? "thermal" : "colour") + ", " +
                    SizeOf(spec.width, spec.height) + ", " + lens +
                    ((*cameras)[i].why.empty() ? "" : "; " + (*cameras)[i].why) +
                    ((*cameras)[i].turned_by_exif
                         ? "; EXIF says that they are to be turned: they are taken as they are "
                           "stored, and the lens must be of that"
                         : ""));
  }
  return lines;
}

Rig MakeRig(const Folders& folders, const std::vector<ReadCamera>& cameras) {
  Rig rig;
  UniqueNames names;
  for (std::size_t i = 0; i < folders.lidars.size(); ++i) {
    LidarSpec& spec = i == 0 ? rig.lidar : rig.further_lidars.emplace_back();
    const std::string& name = folders.lidars[i].name;
    spec.name = name.empty() ? names.Make("lidar") : name;
    names.Insert(spec.name);
  }
  rig.target = folders.board;
  for (const ReadCamera& camera : cameras) rig.cameras.push_back(camera.spec);
  rig.Check(LensNeed::kMayBeUnknown);
  return rig;
}

FileList CloudsOf(const Folders::Lidar& lidar) {
  if (lidar.names.empty()) return ListClouds(lidar.clouds);
  return {lidar.clouds, lidar.names, "cloud"};
}

// Why each of these clouds cannot be used, once they are there.
std::vector<std::string> LookAtClouds(const Folders::Lidar& lidar, const FileList& clouds,
                                      const std::vector<std::size_t>& used) {
  if (lidar.make) {
    std::vector<std::string> names;
    for (const std::size_t i : used) names.push_back(clouds.names[i]);
    lidar.make(names);
  }
  return LookAtClouds(clouds, used);
}

std::vector<ViewFiles> MakeViews(const Folders::Lidar& lidar, const FileList& clouds,
                                 const std::vector<ReadCamera>& cameras,
                                 std::vector<std::string>* left_over) {
  std::map<std::size_t, ViewFiles> of_cloud;
  for (const ReadCamera& camera : cameras) {
    for (std::size_t i = 0; i < camera.images.names.size(); ++i) {
      if (!camera.pairs.cloud_of[i]) continue;
      const std::size_t cloud = *camera.pairs.cloud_of[i];
      ViewFiles& view = of_cloud[cloud];
      if (view.sweep_utime == 0) view.sweep_utime = camera.pairs.cloud_utime[cloud];
      view.images.push_back({camera.spec.name, camera.images.folder / camera.images.names[i],
                             camera.pairs.image_utime[i]});
    }
  }
  std::vector<std::size_t> used;
  used.reserve(of_cloud.size());
  for (const auto& [cloud, view] : of_cloud) used.push_back(cloud);
  const std::vector<std::string> problems = LookAtClouds(lidar, clouds, used);
  std::vector<ViewFiles> views;
  ViewNames names;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (!problems[k].empty()) {
      left_over->push_back(problems[k]);
      continue;
    }
    ViewFiles& view = of_cloud[used[k]];
    view.name = names.NameOf(clouds.names[used[k]]);
    view.cloud = clouds.folder / clouds.names[used[k]];
    views.push_back(std::move(view));
  }
  if (views.empty()) {
    throw InputError("no cloud of " + clouds.folder.string() + " can be used: " + problems.front());
  }
  return views;
}

// What no other file belongs to.
void AddAlone(const FileList& clouds, const std::vector<ReadCamera>& cameras,
              std::vector<std::string>* left_over) {
  std::set<std::size_t> used;
  for (const ReadCamera& camera : cameras) {
    const Pairs& pairs = camera.pairs;
    for (const auto& cloud : pairs.cloud_of) {
      if (cloud) used.insert(*cloud);
    }
    used.insert(camera.without.begin(), camera.without.end());
    std::vector<std::string> alone;
    for (std::size_t i = 0; i < camera.images.names.size(); ++i) {
      if (!pairs.cloud_of[i] && camera.unreadable.count(i) == 0) {
        alone.push_back(camera.images.names[i]);
      }
    }
    if (alone.empty()) continue;
    const bool as_many =
        pairs.by == PairedBy::kNumber && camera.images.names.size() == clouds.names.size();
    left_over->push_back(Counted(alone.size(), "image") + " of " + camera.spec.name +
                         " without a cloud " + pairs.why_not + ": " + Some(alone) +
                         (as_many ? "; there are as many clouds: where the first belongs to the "
                                    "first and so on, say --in-order"
                                  : ""));
  }
  std::vector<std::string> alone;
  for (std::size_t i = 0; i < clouds.names.size(); ++i) {
    if (used.count(i) == 0) alone.push_back(clouds.names[i]);
  }
  if (alone.empty()) return;
  left_over->push_back(Counted(alone.size(), "cloud") + " without an image " +
                       cameras[0].pairs.why_not + ": " + Some(alone));
}

// Of a further LIDAR what belongs to the reference's clouds, to the views that have those.
void AddFurtherClouds(const Folders::Lidar& from, const std::string& lidar,
                      const FileList& reference, const PairOptions& pairing,
                      FolderSession* session) {
  const FileList clouds = CloudsOf(from);
  const Pairs pairs = PairFiles(clouds, reference, pairing);
  std::map<fs::path, ViewFiles*> view_of;
  for (ViewFiles& view : session->views) view_of[view.cloud] = &view;
  std::vector<std::size_t> used;
  std::vector<ViewFiles*> views;
  std::vector<std::string> alone;
  for (std::size_t i = 0; i < clouds.names.size(); ++i) {
    if (!pairs.cloud_of[i]) {
      alone.push_back(clouds.names[i]);
      continue;
    }
    const auto view = view_of.find(reference.folder / reference.names[*pairs.cloud_of[i]]);
    if (view == view_of.end()) continue;
    used.push_back(i);
    views.push_back(view->second);
  }
  std::string why =
      "none of them belongs to a cloud of " + session->rig.lidar.name + " that has an image";
  bool any = false;
  const std::vector<std::string> problems = LookAtClouds(from, clouds, used);
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (problems[k].empty()) {
      views[k]->further_clouds.push_back({lidar, clouds.folder / clouds.names[used[k]]});
      any = true;
    } else {
      session->left_over.push_back(why = problems[k]);
    }
  }
  if (!any) throw InputError("no cloud of " + clouds.folder.string() + " can be used: " + why);
  if (alone.empty()) return;
  session->left_over.push_back(Counted(alone.size(), "cloud") + " of " + lidar +
                               " without a cloud of " + session->rig.lidar.name + " " +
                               pairs.why_not + ": " + Some(alone));
}

void CheckFolders(const Folders& folders) {
  std::set<fs::path> seen;
  for (const Folders::Camera& camera : folders.cameras) {
    if (!seen.insert(fs::weakly_canonical(camera.images)).second) {
      throw InputError("the folder " + camera.images.string() +
                       " is given for two cameras; expected one for each");
    }
  }
  seen.clear();
  for (const Folders::Lidar& lidar : folders.lidars) {
    if (!seen.insert(fs::weakly_canonical(lidar.clouds)).second) {
      throw InputError("the folder " + lidar.clouds.string() +
                       " is given for two LIDARs; expected one for each");
    }
  }
}

}  // namespace

std::vector<std::string> FolderSession::WithoutLens() const {
  std::vector<std::string> names;
  for (const CameraSpec& camera : rig.cameras) {
    if (!camera.lens.known()) names.push_back(camera.name);
  }
  return names;
}

FolderSession ReadFolders(const Folders& folders) {
  CheckFolders(folders);
  const FileList clouds = CloudsOf(folders.lidars.at(0));
  FolderSession session;
  UniqueNames names;
  std::vector<ReadCamera> cameras;
  for (const Folders::Camera& camera : folders.cameras) {
    cameras.push_back(ReadOne(folders, camera, clouds, &names, &session.left_over));
  }
  session.cameras = SetLenses(folders, &cameras);
  session.paired_by = cameras.at(0).pairs.by;
  session.rig = MakeRig(folders, cameras);
  AddAlone(clouds, cameras, &session.left_over);
  session.views = MakeViews(folders.lidars[0], clouds, cameras, &session.left_over);
  for (std::size_t i = 1; i < folders.lidars.size(); ++i) {
    AddFurtherClouds(folders.lidars[i], session.rig.further_lidars[i - 1].name, clouds,
                     folders.pairing, &session);
  }
  return session;
}

void RequireRoomForSession(const fs::path& dir) {
  const fs::path views = dir / "views";
  std::error_code ignored;
  if (fs::exists(views, ignored) && !fs::is_empty(views, ignored)) {
    throw InputError(views.string() +
                     " holds views of an earlier session; remove them or name another directory");
  }
  if (fs::exists(dir / "rig.textproto", ignored)) {
    throw InputError((dir / "rig.textproto").string() +
                     " is an earlier session's; remove it or name another directory");
  }
  CheckWritable(dir / "rig.textproto");
}

void WriteSession(const fs::path& dir, const FolderSession& session) {
  RequireRoomForSession(dir);
  for (const ViewFiles& view : session.views) WriteView(dir, view);
  WriteRig(dir, session.rig);
}

}  // namespace rgbdt
