#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// A session directory: what calibration needs, on disk. Its layout stands in README.md beside.
struct Session {
  std::filesystem::path root;
  Rig rig;
  std::vector<std::string> views;  ///< folders of root/views, sorted with numbers as numbers
};

/// Reads rig.textproto and lists the views. Throws InputError saying what is missing and what to
/// do.
Session OpenSession(const std::filesystem::path& dir, LensNeed lenses = LensNeed::kKnown);

/// Reads one view: its cloud, its images and a person's picks. Where view.textproto does not say
/// whether it is held out, every third view of the session is (the 3rd, 6th, ...). Throws
/// InputError naming file, line and field: a missing file, an image that is not what the rig says
/// (camera, size, channels), a cloud and an image more than 60 s apart.
View ReadView(const Session& session, const std::string& view);

/// The same without its cloud, which then need not be there.
View ReadImages(const Session& session, const std::string& view);

/// The cloud alone; the view then need not have images.
Cloud ReadCloud(const Session& session, const std::string& view);

/// Writes rig.textproto: the rig's own text where it has one, so that its hash stays.
void WriteRig(const std::filesystem::path& session_dir, const Rig& rig);

/// Writes views/NAME: cloud.pcd, one PNG an image, and last view.textproto.
void WriteView(const std::filesystem::path& session_dir, const View& view);

/// truth.textproto, where there is one. Throw InputError.
Truth ReadTruth(const std::filesystem::path& path);
/// `remark`: lines for a person, written as a comment.
void WriteTruth(const std::filesystem::path& path, const Truth& truth,
                const std::string& remark = "");

}  // namespace rgbdt
