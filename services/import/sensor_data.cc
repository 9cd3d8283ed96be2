#include "services/import/sensor_data.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/model/livox.h"
#include "calib/model/text.h"
#include "services/bags/printable.h"

namespace rgbdt {
namespace {

// A PointCloud2 differs from a PCD in its header only, so it is read as one: what fields mean is
// decided there.
struct PcdField {
  std::string name;
  char type = 'U';
  std::size_t size = 1, count = 1, offset = 0;
};

constexpr struct {
  char type;
  std::size_t size;
} kDatatypes[] = {{'I', 1}, {'U', 1}, {'I', 2}, {'U', 2}, {'I', 4}, {'U', 4}, {'F', 4}, {'F', 8}};

bool IsSmallWhole(const PcdField& field) { return field.type != 'F' && field.size <= 2; }

class PcdFields {
 public:
  PcdFields(const ros::PointCloud& cloud, const std::string& where) {
    for (const ros::PointCloud::Field& field : cloud.fields) {
      if (field.datatype < 1 || field.datatype > 8) {
        throw InputError(where + ": field \"" + Printable(field.name) + "\" has datatype " +
                         std::to_string(field.datatype) + "; expected 1 to 8");
      }
      const auto& type = kDatatypes[field.datatype - 1];
      const std::size_t count = std::max<std::uint32_t>(1, field.count);
      if (field.offset + count * type.size > cloud.point_step) {
        throw InputError(where + ": field \"" + Printable(field.name) +
                         "\" lies beyond the point's " + std::to_string(cloud.point_step) +
                         " bytes");
      }
      all_[field.name] = {field.name, type.type, type.size, count, field.offset};
    }
    Choose();
  }

  const PcdField* Find(const std::string& name) const {
    const auto found = all_.find(name);
    return found == all_.end() ? nullptr : &found->second;
  }

  // In the order of their offsets, gaps filled by what nobody reads.
  std::vector<PcdField> WithGaps(std::size_t point_bytes, const std::string& where) const {
    std::vector<PcdField> chosen = chosen_;
    std::sort(chosen.begin(), chosen.end(),
              [](const PcdField& a, const PcdField& b) { return a.offset < b.offset; });
    std::vector<PcdField> fields;
    std::size_t at = 0;
    const auto fill = [&](std::size_t to) {
      if (to > at) fields.push_back({"_", 'U', 1, to - at, at});
    };
    for (const PcdField& field : chosen) {
      if (field.offset < at) {
        throw InputError(where + ": field \"" + field.name + "\" lies over another one");
      }
      fill(field.offset);
      fields.push_back(field);
      at = field.offset + field.size * field.count;
    }
    fill(point_bytes);
    return fields;
  }

 private:
  void Choose() {
    for (const char* name :
         {"x", "y", "z", "dir_x", "dir_y", "dir_z", "origin_x", "origin_y", "origin_z"}) {
      Take(name, name);
    }
    if (!Take("intensity", "intensity")) Take("reflectivity", "intensity");
    const bool organised_by_fields = Find("line") != nullptr && Find("beam") != nullptr;
    if (organised_by_fields) {
      Take("line", "line");
      Take("beam", "beam");
    }
    const bool livox = Find("line") != nullptr && Find("tag") != nullptr;
    if (!Take("ring", "ring") && !livox) {
      for (const char* name : {"channel", "line"}) {
        const PcdField* field = Find(name);
        if (field == nullptr || !IsSmallWhole(*field) || organised_by_fields) continue;
        Take(name, "ring");
        break;
      }
    }
    for (const char* name : {"timestamp", "time_stamp", "time", "t", "offset_time"}) {
      if (Take(name, name)) return;
    }
  }

  bool Take(const std::string& name, const std::string& as) {
    const PcdField* field = Find(name);
    if (field == nullptr) return false;
    chosen_.push_back(*field);
    chosen_.back().name = as;
    return true;
  }

  std::map<std::string, PcdField> all_;
  std::vector<PcdField> chosen_;
};

std::string PcdHeader(const std::vector<PcdField>& fields, const ros::PointCloud& cloud) {
  std::string names, sizes, types, counts;
  for (const PcdField& field : fields) {
    names += " " + field.name;
    sizes += " " + std::to_string(field.size);
    types += std::string(" ") + field.type;
    counts += " " + std::to_string(field.count);
  }
  return "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
         "\nWIDTH " + std::to_string(cloud.width) + "\nHEIGHT " + std::to_string(cloud.height) +
         "\nDATA binary\n";
}

// How far rows lie apart [B]. Where they fill the message without gaps nothing else is meant: some
// drivers leave row_step at 0, or give the bytes of all rows.
std::uint64_t RowStep(const ros::PointCloud& cloud) {
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  return cloud.height <= 1 || cloud.size == row * cloud.height ? row : cloud.row_step;
}

void CheckShape(const ros::PointCloud& cloud, const std::string& where) {
  if (cloud.big_endian) throw InputError(where + ": its points are big-endian; expected little");
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.width == 0 || cloud.height == 0 || cloud.point_step == 0) {
    throw InputError(where + ": holds no points");
  }
  const std::uint64_t step = RowStep(cloud);
  if (step < row || cloud.size < row ||
      (cloud.height > 1 && (cloud.size - row) / step < cloud.height - 1)) {
    throw InputError(where + ": is cut short: " + std::to_string(cloud.width) + " x " +
                     std::to_string(cloud.height) + " points of " +
                     std::to_string(cloud.point_step) + " bytes, rows " + std::to_string(step) +
                     " bytes apart, are announced, " + std::to_string(cloud.size) +
                     " bytes are there");
  }
  if (std::uint64_t{cloud.width} * cloud.height > kMostSweepPoints) {
    throw InputError(where + ": has " + std::to_string(cloud.width) + " x " +
                     std::to_string(cloud.height) + " points; expected at most " +
                     std::to_string(kMostSweepPoints));
  }
}

// Of a Livox only normal points: those that stay, one after the other.
void KeepNormal(const ros::PointCloud& cloud, const PcdFields& fields, std::string* points) {
  const PcdField *tag = fields.Find("tag"), *x = fields.Find("x");
  const auto is_byte = [](const PcdField* field) { return field->type != 'F' && field->size == 1; };
  const bool floats = x != nullptr && x->type == 'F' && x->size == 4;
  if (!is_byte(tag) || !floats) return;
  std::size_t kept = 0;
  for (std::size_t at = 0; at < points->size(); at += cloud.point_step) {
    float place[3] = {0, 0, 0};
    const char* names[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
      const PcdField* field = fields.Find(names[k]);
      if (field != nullptr && field->size == 4) {
        std::memcpy(&place[k], points->data() + at + field->offset, 4);
      }
    }
    const bool nothing = place[0] == 0 && place[1] == 0 && place[2] == 0;
    if (nothing || !IsNormalLivoxPoint(static_cast<std::uint8_t>((*points)[at + tag->offset]))) {
      continue;
    }
    std::copy_n(points->data() + at, cloud.point_step, points->data() + kept);
    kept += cloud.point_step;
  }
  points->resize(kept);
}

template <typename Numbers>
std::string YamlList(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + Exact(number);
  return "[" + text + "]";
}

}  // namespace

bool IsLivox(const ros::PointCloud& cloud) {
  int found = 0;
  for (const ros::PointCloud::Field& field : cloud.fields) {
    found |= field.name == "tag" ? 1 : field.name == "line" ? 2 : field.name == "ring" ? 4 : 0;
  }
  return found == 3 && cloud.height == 1;
}

Cloud ToCloud(const ros::PointCloud& cloud, const std::string& where) {
  CheckShape(cloud, where);
  const PcdFields known(cloud, where);
  for (const char* name : {"x", "y", "z"}) {
    if (known.Find(name) != nullptr) continue;
    std::string names;
    for (const ros::PointCloud::Field& field : cloud.fields) names += " " + Printable(field.name);
    throw InputError(where + ": has no field " + name + "; its fields are:" + names);
  }
  const std::vector<PcdField> fields = known.WithGaps(cloud.point_step, where);
  const std::size_t row = std::size_t{cloud.width} * cloud.point_step;
  std::string points;
  points.reserve(row * cloud.height);
  for (std::size_t y = 0; y < cloud.height; ++y) {
    points.append(reinterpret_cast<const char*>(cloud.data) + y * RowStep(cloud), row);
  }
  ros::PointCloud head = cloud;
  if (IsLivox(cloud)) {
    KeepNormal(cloud, known, &points);
    head.width = static_cast<std::uint32_t>(points.size() / cloud.point_step);
    if (head.width == 0) throw InputError(where + ": holds no points that its tags call normal");
  }
  return ParsePcd(PcdHeader(fields, head) + points, where, cloud.header.utime);
}

std::optional<FileLens> ToLens(const ros::CameraInfo& info, const LensWanted& wanted) {
  if (std::all_of(info.k.begin(), info.k.end(), [](double k) { return k == 0; })) {
    return std::nullopt;
  }
  const std::string where = wanted.file.string();
  if (info.binning_x > 1 || info.binning_y > 1) {
    throw InputError(where + ": binning " + std::to_string(info.binning_x) + " x " +
                     std::to_string(info.binning_y) +
                     ": its K is of images that are larger; give the lens by --lens");
  }
  // One reader judges both, the topic and the file that camera_calibration writes.
  std::string text;
  if (info.width != 0 || info.height != 0) {  // some drivers leave both at 0
    text =
        "width: " + std::to_string(info.width) + "\nheight: " + std::to_string(info.height) + "\n";
  }
  text += "K: " + YamlList(info.k) + "\nD: " + YamlList(info.d) +
          "\nroi:\n  x_offset: " + std::to_string(info.roi_x) +
          "\n  y_offset: " + std::to_string(info.roi_y) + "\n";
  std::string model = info.distortion_model.substr(0, 40);
  model.erase(std::remove_if(model.begin(), model.end(),
                             [](unsigned char c) { return std::isalnum(c) == 0 && c != '_'; }),
              model.end());
  if (!model.empty()) text += "distortion_model: " + model + "\n";
  return ParseLensFile(text, wanted);
}

}  // namespace rgbdt
