#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// A session directory: what calibration needs, on disk. Its layout stands in README.md beside. Or
/// several of them as one (JoinSessions).
struct Session {
  std::filesystem::path root;  ///< of a joined one: empty
  Rig rig;
  std::vector<std::string> views;  ///< folders of root/views, sorted by NaturalLess

  struct Part;
  std::vector<Part> parts{};  ///< of a joined one

  /// For a person: the directory, or the names of the parts.
  std::string Title() const;
};

struct Session::Part {
  std::string name;
  Session session;
};

/// Reads rig.textproto and lists the views. Throws InputError saying what is missing and what to
/// do.
Session OpenSession(const std::filesystem::path& dir, LensNeed lenses = LensNeed::kKnown);

/// Several sessions of one rig as one, whose view "monday/0001" is the view 0001 of the session
/// that is called monday: after its folder, or after its whole path where two folders are called
/// the same. Throws InputError where a session is given twice, or rigs differ in what a calibration
/// depends on, with what differs.
Session JoinSessions(std::vector<Session> sessions);

/// A joined session's parts, each with the names that its views have there.
std::vector<Session> PartsOf(const Session& joined);

/// Reads one view: its cloud, its images and a person's picks. Where view.textproto does not say
/// whether it is held out, every third view of the session is (the 3rd, 6th, ...). Throws
/// InputError naming file, line and field: a missing file, an image that is not what the rig says
/// (camera, size, channels), a cloud and an image more than 60 s apart.
View ReadView(const Session& session, const std::string& view);

/// The same without its cloud, which then need not be there.
View ReadImages(const Session& session, const std::string& view);

/// The cloud alone; the view then need not have images.
Cloud ReadCloud(const Session& session, const std::string& view);

/// Moves what an earlier run left in `dir` out of the way of a run that begins, so that it is not
/// taken for that one's where it fails: calibration.textproto becomes
/// calibration.previous.textproto, report.json and report.html likewise, in place of what these
/// names held. Reports without a calibration never take the place of an earlier run's results: they
/// are removed. Says in words what was kept; empty: nothing. Throws InputError where a file cannot
/// be renamed.
std::string SetResultsAside(const std::filesystem::path& dir);

/// Gives the cameras that have no timing that of the calibration which SetResultsAside moved away
/// in `dir`, where they are the same cameras: views of a board that stands tell nothing of clocks.
/// Says in words whose; empty: nobody's.
std::string KeepTimings(const std::filesystem::path& dir, const Rig& rig, Report* report);

/// Renames views/VIEW so that no one takes it for a view: nothing is lost, and its name is free.
/// Returns what it is called now. Throws InputError where it cannot be renamed.
std::string SetViewAside(const std::filesystem::path& dir, const std::string& view);

/// Writes rig.textproto: the rig's own text where it has one, so that its hash stays.
void WriteRig(const std::filesystem::path& session_dir, const Rig& rig);

/// Writes views/NAME: cloud.pcd, one PNG an image, and last view.textproto. A new one is there
/// whole or not at all (it is written beside, as .NAME.part, and renamed); of one that is there
/// already each file is.
void WriteView(const std::filesystem::path& session_dir, const View& view);

/// A view of files that lie elsewhere.
struct ViewFiles {
  struct OfCamera {
    std::string camera;
    std::filesystem::path file;
    Utime utime = 0;  ///< 0: unknown
  };
  std::string name;
  std::filesystem::path cloud;
  Utime sweep_utime = 0;  ///< 0: unknown
  std::vector<OfCamera> images;
  struct OfLidar {
    std::string lidar;
    std::filesystem::path file;
  };
  std::vector<OfLidar> further_clouds{};
};

/// Writes views/NAME/view.textproto, which names the files by their whole paths; nothing is copied.
/// Whether it is held out is left to its place in the session.
void WriteView(const std::filesystem::path& session_dir, const ViewFiles& view);

/// truth.textproto, where there is one. Throw InputError.
Truth ReadTruth(const std::filesystem::path& path);
/// `remark`: lines for a person, written as a comment.
void WriteTruth(const std::filesystem::path& path, const Truth& truth,
                const std::string& remark = "");

}  // namespace rgbdt
