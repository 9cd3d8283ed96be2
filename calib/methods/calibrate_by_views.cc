#include "calib/methods/calibrate_by_views.h"

#include <set>

#include "calib/model/method.h"
#include "calib/model/text.h"

namespace rgbdt {

std::vector<Report> CalibrateByViews(const Rig& rig, const std::vector<Observation>& observations,
                                     const Report& report) {
  std::vector<Report> reports;
  CalibrateOptions options;
  options.diagnostics = false;
  std::set<std::string, decltype(&NaturalLess)> used(&NaturalLess);
  for (const CameraReport& camera : report.cameras) {
    used.insert(camera.used.begin(), camera.used.end());
  }
  std::vector<Observation> so_far;
  for (const std::string& view : used) {
    if (report.method != kAutoMethod || view == *used.rbegin()) break;
    for (const Observation& o : observations) {
      if (o.view == view) so_far.push_back(o);
    }
    reports.push_back(Calibrate(rig, so_far, options));
  }
  reports.push_back(report);
  return reports;
}

}  // namespace rgbdt
