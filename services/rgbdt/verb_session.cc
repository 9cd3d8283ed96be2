#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/image_files.h"
#include "calib/files/import/board_text.h"
#include "calib/files/import/folders.h"
#include "calib/methods/board_check.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/rgbdt/folder_flags.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// "pose7.png", and with times how far it is from the cloud: "1700000000.25.png (+12 ms)".
std::string ImageText(const ViewFiles::OfCamera& image, Utime sweep_utime) {
  std::string text = image.file.filename().string();
  if (image.utime == 0 || sweep_utime == 0) return text;
  return text + Format(" (%+.0f ms)", 1e3 * ToSeconds(image.utime - sweep_utime));
}

void PrintViews(const FolderSession& session) {
  std::printf("%zu %s, paired %s:\n", session.views.size(),
              session.views.size() == 1 ? "view" : "views", NameOf(session.paired_by).c_str());
  for (const ViewFiles& view : session.views) {
    std::string line = view.cloud.filename().string();
    for (const CameraSpec& camera : session.rig.cameras) {
      const auto found =
          std::find_if(view.images.begin(), view.images.end(),
                       [&](const auto& image) { return image.camera == camera.name; });
      line += "  " + camera.name + ": " +
              (found == view.images.end() ? "none" : ImageText(*found, view.sweep_utime));
    }
    for (const LidarSpec& lidar : session.rig.further_lidars) {
      const auto found = std::find_if(view.further_clouds.begin(), view.further_clouds.end(),
                                      [&](const auto& cloud) { return cloud.lidar == lidar.name; });
      line += "  " + lidar.name + ": " +
              (found == view.further_clouds.end() ? "none" : found->file.filename().string());
    }
    std::printf("  %s\n", line.c_str());
  }
  for (const std::string& line : session.left_over) std::printf("left over: %s\n", line.c_str());
}

// Some of a camera's images, from the first to the last.
std::vector<Image> SomeImages(const FolderSession& session, const CameraSpec& camera) {
  constexpr std::size_t kImages = 3;
  std::vector<fs::path> files;
  for (const ViewFiles& view : session.views) {
    for (const ViewFiles::OfCamera& image : view.images) {
      if (image.camera == camera.name) files.push_back(image.file);
    }
  }
  std::vector<Image> images;
  const std::size_t count = std::min(kImages, files.size());
  for (std::size_t i = 0; i < count; ++i) {
    Image& image = images.emplace_back();
    image.camera = camera.name;
    image.pixels = DecodeImageFile(files[(2 * i + 1) * files.size() / (2 * count)]);
    if (camera.kind == CameraKind::kColor) EightBits(&image.pixels);
    if (camera.kind == CameraKind::kThermal) image.pixels = OneChannelOfGrey(image.pixels);
    image.format = FormatOf(static_cast<PixelFormat>(0), &image.pixels);
  }
  return images;
}

// Told in seconds, before anything is written: counts that are of inner corners.
void CheckBoardIsSeen(const FolderSession& session) {
  const Target& board = session.rig.target;
  if (!board.HasPattern()) return;
  const auto& cameras = session.rig.cameras;
  const auto colour = std::find_if(cameras.begin(), cameras.end(), [](const CameraSpec& camera) {
    return camera.kind == CameraKind::kColor;
  });
  if (colour == cameras.end() && board.holes) return;  // who sees no markers finds its outline
  const CameraSpec& camera = colour == cameras.end() ? cameras[0] : *colour;
  const BoardCheck check = CheckBoard(camera, board, SomeImages(session, camera));
  if (check.instead) {
    throw InputError("--board: " + camera.name + ": " + OtherBoard(board, check));
  }
  if (check.found) return;
  std::printf("warning: the board is in none of the images of %s looked at: %s\n",
              camera.name.c_str(), check.why.c_str());
}

int RunSession(const FolderFlags& flags) {
  const Folders folders = FoldersOf(flags);
  RequireRoomForSession(flags.out);
  return MakeSession(folders, flags.out);
}

}  // namespace

std::pair<std::string, std::string> SplitName(const std::string& text) {
  const std::size_t equals = text.find('=');
  const bool named = equals != std::string::npos && !fs::exists(text) &&
                     text.substr(0, equals).find('/') == std::string::npos;
  if (!named) return {"", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Folders FoldersOf(const FolderFlags& flags) {
  if (flags.pinhole && flags.fisheye) {
    throw InputError("--pinhole and --fisheye are both given; a lens is one of the two");
  }
  Folders folders;
  folders.board = ParseBoard(flags.board);
  for (const std::string& text : flags.images) {
    const auto [name, path] = SplitName(text);
    folders.cameras.push_back({name, path});
  }
  for (const std::string& text : flags.lenses) folders.lenses.push_back(LensFileOf(text));
  for (const std::string& text : flags.clouds) {
    const auto [name, path] = SplitName(text);
    folders.lidars.push_back({name, path});
  }
  if (flags.pinhole) folders.model = Lens::Model::kPinhole;
  if (flags.fisheye) folders.model = Lens::Model::kFisheye;
  folders.pairing = flags.pairing;
  return folders;
}

int MakeSession(const Folders& folders, const std::string& out) {
  const FolderSession session = ReadFolders(folders);
  CheckBoardIsSeen(session);
  for (const std::string& line : session.cameras) std::printf("%s\n", line.c_str());
  if (!session.rig.further_lidars.empty()) {
    std::printf("lidar %s: the reference, in whose frame all poses are\n",
                session.rig.lidar.name.c_str());
  }
  std::printf("board: %s\n", DescribeBoard(session.rig.target).c_str());
  PrintViews(session);
  WriteSession(out, session);
  std::printf("wrote %s: rig.textproto, %zu %s; images and clouds stay where they are\n",
              out.c_str(), session.views.size(), session.views.size() == 1 ? "view" : "views");
  return FinishSession(out, session.WithoutLens());
}

Folders::LensFile LensFileOf(const std::string& text) {
  const auto [name, path] = SplitName(text);
  const std::size_t colon = path.rfind(':');
  if (fs::exists(path) || colon == std::string::npos) return {name, path, ""};
  return {name, path.substr(0, colon), path.substr(colon + 1)};
}

int FinishSession(const std::string& session_dir, const std::vector<std::string>& unknown) {
  if (!unknown.empty() && !FindLenses(session_dir, unknown)) {
    std::printf(
        "next: take more views and make the session anew, or write the lens into "
        "%s/rig.textproto\n",
        session_dir.c_str());
    return 1;
  }
  std::printf("next: rgbdt calibrate %s\n", ForShell(session_dir).c_str());
  return 0;
}

void AddSession(CommandLine* program) {
  auto flags = std::make_shared<FolderFlags>();
  CommandLine* verb = program->Verb(
      "session",
      "Makes a session directory of folders of images and of clouds, ready for `rgbdt\n"
      "calibrate`. Nothing is copied: it names the files. An image and its cloud belong together\n"
      "by their names, the numbers in them, or the times that they are. A lens that no file says\n"
      "is found from the images, as by `rgbdt intrinsics`. Exit code 1: it was not found.\n"
      "With live sensors it is rgbdt-session that makes one.\n"
      "Examples: rgbdt session --images images --clouds clouds --lens camera_info.yaml \\\n"
      "            --board 8x6@0.095,0.85x0.61 --out out/session\n"
      "          rgbdt session --images rgb=left --images thermal=ir --lens camchain.yaml \\\n"
      "            --clouds pcd --board 11x8@0.1,1.2192x0.9144 --out out/session\n"
      "          rgbdt session --images images --lens camera_info.yaml --clouds front=pcd_front "
      "\\\n"
      "            --clouds rear=pcd_rear --board 8x6@0.095,0.85x0.61 --out out/session",
      [flags] { return RunSession(*flags); });
  verb->Required(
      "--images", &flags->images,
      "[NAME=]DIR, a camera's folder of images; given again for each camera. Without a\n"
      "name it is rgb, or thermal where the folder says so, or images are one channel of\n"
      "16 bits with a thermal camera's values; NAME rgb or thermal says which it is");
  verb->Required(
      "--clouds", &flags->clouds,
      "[NAME=]DIR, the folder of clouds: PCD, PLY, or .bin as KITTI and nuScenes have them;\n"
      "given again for each LIDAR, the reference first: the poses of the others are found\n"
      "from their clouds of the same boards");
  verb->Required(
      "--board", &flags->board,
      "SQUARESxSQUARES@SQUARE,WIDTHxHEIGHT in metres: squares along the width and the\n"
      "height, a square's side, the whole board with its border. Squares, not inner\n"
      "corners, which are one fewer each way and are written 7x5corners@... A pattern that\n"
      "is not in the middle of its board: write pattern_offset_m into the rig file. A board\n"
      "without a pattern: plain@WIDTHxHEIGHT. With markers: charuco@SQUARESxSQUARES,SQUARE,\n"
      "MARKER,DICTIONARY,WIDTHxHEIGHT[,legacy] (charuco@8x6,0.095,0.07,5X5_100,0.85x0.61),\n"
      "or Kalibr's aprilgrid@TAGSxTAGS,TAG,SPACING,FAMILY,WIDTHxHEIGHT. With four holes: "
      "velo2cam@MARKER or fast-calib@MARKER, its markers' side");
  verb->Required("--out", &flags->out, "the session directory to write");
  verb->Option("--lens", &flags->lenses,
               "[NAME=]FILE[:PART], in the order of the cameras: YAML of OpenCV, ROS camera_info,\n"
               "or a Kalibr camchain, whose part (cam1) is told by its rostopic or place");
  verb->Flag("--pinhole", &flags->pinhole,
             "without --lens: the lens is a pinhole, found from the images");
  verb->Flag("--fisheye", &flags->fisheye,
             "the same, a fisheye. Either also says what a file's 4 coefficients are");
  verb->Flag("--in-order", &flags->pairing.in_order,
             "pair the first image with the first cloud and so on, whatever they are called");
  verb->Within("--max-apart", &flags->pairing.max_apart_s, 0, 60,
               "of names that are times: how far an image and its cloud may be apart [s]");
}

}  // namespace rgbdt
