#include "calib/files/schema/internal/export_parts.h"

#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt::exports {

std::vector<Exported> Match(const Rig& rig, const Calibration& calibration) {
  std::vector<Exported> cameras;
  for (const CameraCalibration& camera : calibration.cameras) {
    cameras.push_back({camera.WithSolvedLens(rig.Camera(camera.camera)), camera});
  }
  if (cameras.empty()) throw InputError("the calibration holds no camera: nothing to export");
  return cameras;
}

std::string List(const double* values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i > 0 ? " " : "") + Exact(values[i]);
  return text;
}

std::string YamlNumber(double value) {
  std::string number = Exact(value);
  const std::size_t exponent = number.find('e');
  if (exponent != std::string::npos && number.find('.') == std::string::npos) {
    number.insert(exponent, ".0");
  }
  return number;
}

std::string YamlList(const double* values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + YamlNumber(values[i]);
  return "[" + text + "]";
}

Eigen::Matrix4d MatrixOf(const Rigid3& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = text::Normalised(pose.rotation).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.translation;
  return matrix;
}

bool HasTerms(const Lens& lens, std::size_t from) {
  for (std::size_t i = from; i < lens.distortion.size(); ++i) {
    if (lens.distortion[i] != 0) return true;
  }
  return false;
}

std::string StatusWarning(const Exported& camera) {
  if (camera.calibration.converged()) return {};
  std::string status = camera.calibration.StatusText();
  for (char& c : status) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return "WARNING: " + camera.spec.name + " did not converge: " + PrintableText(status);
}

std::string HashComment(const std::string& text) {
  std::string comment = "# ";
  for (const char c : text) comment += c == '\n' ? std::string("\n# ") : std::string(1, c);
  return comment + "\n";
}

}  // namespace rgbdt::exports
