#include "calib/files/import/internal/folder_files.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/import/camera_kind.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/model/image_codec.h"
#include "calib/model/parallel.h"
#include "calib/model/printable.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthestM = 500;  // no LIDAR has half of its returns from beyond

std::string EndingOf(const fs::path& path) { return ToLower(path.extension().string()); }

// What a folder holds besides: kinds of files, and folders by their names.
struct Others {
  std::map<std::string, int> endings;
  std::set<std::string> folders;
};

// The first few, as there may be very many.
std::string Listed(const std::vector<std::string>& words) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, words.size()); ++i) {
    text += (i == 0 ? "" : ", ") + words[i];
  }
  return words.size() > kMost ? text + " and " + std::to_string(words.size() - kMost) + " more"
                              : text;
}

std::string Described(const Others& others) {
  std::vector<std::string> files, folders;
  for (const auto& [ending, count] : others.endings) {
    files.push_back(std::to_string(count) + " " + (ending.empty() ? "without an ending" : ending));
  }
  for (const std::string& name : others.folders) folders.push_back(name + "/");
  if (files.empty() && folders.empty()) return "nothing";
  return Listed(files) + (files.empty() || folders.empty() ? "" : " and ") + Listed(folders);
}

// Names are printed, and stand in texts and pages.
void CheckName(const fs::path& folder, const std::string& name) {
  if (IsPrintable(name)) return;
  throw InputError(folder.string() + "/" + PrintableText(name) +
                   ": its name has a control character or is not UTF-8; rename it");
}

FileList List(const fs::path& folder, const std::set<std::string>& endings, const char* what,
              const char* wanted) {
  if (!fs::is_directory(folder)) throw InputError("there is no folder " + folder.string());
  FileList files{folder, {}, what};
  Others others;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.front() == '.') continue;
    if (it->is_directory(error)) {
      others.folders.insert(name);
    } else if (endings.count(EndingOf(it->path())) != 0) {
      CheckName(folder, name);
      files.names.push_back(name);
    } else {
      ++others.endings[EndingOf(it->path())];
    }
  }
  if (error) throw InputError("cannot list " + folder.string() + ": " + error.message());
  if (files.names.empty()) {
    throw InputError(folder.string() + " holds no " + wanted + "; it has " + Described(others));
  }
  std::sort(files.names.begin(), files.names.end(), NaturalLess);
  return files;
}

ImageFacts LookAt(const fs::path& path) {
  ImageFacts facts;
  try {
    constexpr std::size_t kHeadBytes = 64 * 1024;
    const std::string head = ReadFileHead(path, kHeadBytes);
    facts.turned_by_exif = IsTurnedByExif(head.data(), head.size());
    cv::Mat pixels = DecodeImageFile(path);
    facts.grey = OneChannelOfGrey(pixels).channels() == 1;
    facts.width = pixels.cols;
    facts.height = pixels.rows;
    try {
      facts.format = FormatOf(static_cast<PixelFormat>(0), &pixels);
      if (facts.format == PixelFormat::kMono16) facts.dark_over_bright = DarkOverBright(pixels);
    } catch (const InputError& error) {
      facts.problem = path.string() + " " + error.what();
    }
  } catch (const InputError& error) {
    facts.problem = error.what();
  }
  return facts;
}

struct CloudFacts {
  std::string problem;
  double median_m = 0;
};

CloudFacts LookAtCloud(const fs::path& path) {
  CloudFacts facts;
  try {
    const Cloud cloud = ReadSweep(path);
    std::vector<float> ranges;
    for (const Eigen::Vector3f& point : cloud.points) {
      if (point.allFinite()) ranges.push_back(point.norm());
    }
    facts.median_m = Median(std::move(ranges));
  } catch (const InputError& error) {
    facts.problem = error.what();
  }
  return facts;
}

}  // namespace

FileList ListImages(const fs::path& folder) {
  return List(folder, {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm"}, "image",
              "image (png, jpg, tif, bmp, pgm, ppm)");
}

FileList ListClouds(const fs::path& folder) {
  return List(folder, {".pcd", ".ply", ".bin"}, "cloud",
              "cloud; expected PCD or PLY files, or .bin as KITTI's");
}

std::vector<ImageFacts> LookAtImages(const FileList& files, const std::vector<std::size_t>& which) {
  std::vector<ImageFacts> facts(which.size());
  ForEach(static_cast<int>(which.size()), 0, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    facts[k] = LookAt(files.folder / files.names[which[k]]);
  });
  return facts;
}

std::vector<std::string> LookAtClouds(const FileList& files,
                                      const std::vector<std::size_t>& which) {
  std::vector<CloudFacts> facts(which.size());
  ForEach(static_cast<int>(which.size()), 0, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    facts[k] = LookAtCloud(files.folder / files.names[which[k]]);
  });
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < facts.size(); ++i) {
    if (facts[i].median_m > kFarthestM) {
      throw InputError(
          (files.folder / files.names[which[i]]).string() + ": half of its points lie " +
          Format("%.0f", facts[i].median_m) +
          " m away or more, which looks like millimetres or centimetres; expected metres");
    }
    problems.push_back(facts[i].problem);
  }
  return problems;
}

}  // namespace rgbdt
