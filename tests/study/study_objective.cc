// The objectives of `paper` and `auto` about the truth, as in the paper's Figures 8 and 9.
//   study_objective slices|surfaces STEPS SEED CSV
// A rendered session of 10 views (paired_sessions.h), both cameras. slices: each parameter from end
// to end (30 deg, 3 m) in 2 STEPS + 1 values, with 1, 2, 5 and 10 views. surfaces: each pair of
// parameters, the colour camera, 10 views; beside CSV, hollows.csv tells where one ends who goes
// downhill from each low place of the grid. A line of CSV for each place; see objectives.h for what
// is minimised.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

#include "tests/study/objectives.h"
#include "tests/study/study_main.h"
#include "tests/study/surface_minima.h"

namespace rgbdt::study {
namespace {

constexpr int kViews = 10;

PairedSession AnySession(std::uint64_t seed) {
  PairedOptions options;
  options.views = kViews;
  for (std::uint64_t tries = 0; tries < 20; ++tries) {
    auto session = MakePairedSession(options, seed + 1000 * tries);
    if (session) return std::move(*session);
  }
  throw std::runtime_error("no room");
}

// Offset of a parameter at step -steps ... steps.
double Offset(std::size_t parameter, int step, int steps) {
  return (parameter < 3 ? kMostTurnDeg : kMostShiftM) * step / steps;
}

void WriteValues(const Objectives& objectives, const Rigid3& pose, std::ofstream* csv) {
  *csv << objectives.Paper(pose, FieldBeyond::kBorderValue) << ','
       << objectives.Paper(pose, FieldBeyond::kSmooth) << ',' << objectives.Auto(pose) << '\n';
}

void WriteSlices(const PairedSession& session, int steps, std::ofstream* csv) {
  *csv << "camera,views,parameter,offset,paper,paper_smooth,auto\n";
  for (std::size_t camera = 0; camera < session.rig.cameras.size(); ++camera) {
    for (const int views : {1, 2, 5, kViews}) {
      const Objectives objectives(session, camera, views);
      for (std::size_t p = 0; p < kParameters.size(); ++p) {
        for (int step = -steps; step <= steps; ++step) {
          std::array<double, 6> by{};
          by[p] = Offset(p, step, steps);
          *csv << session.rig.cameras[camera].name << ',' << views << ',' << kParameters[p] << ','
               << by[p] << ',';
          WriteValues(objectives, Moved(objectives.truth(), by), csv);
        }
      }
      std::printf("slices: %s, %d views\n", session.rig.cameras[camera].name.c_str(), views);
      std::fflush(stdout);
    }
  }
}

struct Method {
  const char* name;
  std::function<double(const Rigid3&)> objective;
};

std::vector<Method> MethodsOf(const Objectives& objectives) {
  return {
      {"paper", [&](const Rigid3& p) { return objectives.Paper(p, FieldBeyond::kBorderValue); }},
      {"paper_smooth", [&](const Rigid3& p) { return objectives.Paper(p, FieldBeyond::kSmooth); }},
      {"auto", [&](const Rigid3& p) { return objectives.Auto(p); }}};
}

// One pair of parameters by all methods.
class PairOfParameters {
 public:
  PairOfParameters(const Objectives& objectives, std::size_t a, std::size_t b, int steps)
      : objectives_(objectives), methods_(MethodsOf(objectives)), a_(a), b_(b), steps_(steps) {
    surfaces_.assign(methods_.size(), {steps, {}});
    for (int i = -steps; i <= steps; ++i) {
      for (int j = -steps; j <= steps; ++j) {
        const Rigid3 pose = PoseAt(Eigen::Vector2d(i, j) / steps);
        for (std::size_t m = 0; m < methods_.size(); ++m) {
          surfaces_[m].values.push_back(methods_[m].objective(pose));
        }
      }
    }
  }

  void WriteSurface(std::ofstream* csv) const {
    for (int i = 0; i < surfaces_[0].side(); ++i) {
      for (int j = 0; j < surfaces_[0].side(); ++j) {
        *csv << kParameters[a_] << ',' << kParameters[b_] << ',' << Offset(a_, i - steps_, steps_)
             << ',' << Offset(b_, j - steps_, steps_);
        for (const Surface& surface : surfaces_) *csv << ',' << surface.At(i, j);
        *csv << '\n';
      }
    }
  }

  void WriteHollows(std::ofstream* csv) const {
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      const auto function = [&](const Eigen::Vector2d& p) {
        return methods_[m].objective(PoseAt(p));
      };
      for (const Hollow& hollow : FindHollows(surfaces_[m], function)) {
        *csv << kParameters[a_] << ',' << kParameters[b_] << ',' << methods_[m].name << ','
             << hollow.i << ',' << hollow.j << ',' << hollow.end.x() * Offset(a_, 1, 1) << ','
             << hollow.end.y() * Offset(b_, 1, 1) << ',' << hollow.value << '\n';
      }
    }
  }

 private:
  Rigid3 PoseAt(const Eigen::Vector2d& place) const {
    std::array<double, 6> by{};
    by[a_] = place.x() * Offset(a_, 1, 1);
    by[b_] = place.y() * Offset(b_, 1, 1);
    return Moved(objectives_.truth(), by);
  }

  const Objectives& objectives_;
  std::vector<Method> methods_;
  std::size_t a_, b_;
  int steps_;
  std::vector<Surface> surfaces_;  // by method
};

void WriteSurfaces(const PairedSession& session, int steps, const std::string& path,
                   std::ofstream* csv) {
  std::ofstream hollows(std::filesystem::path(path).replace_filename("hollows.csv"));
  *csv << "parameter,other,offset,other_offset,paper,paper_smooth,auto\n";
  hollows << "parameter,other,method,i,j,offset,other_offset,value\n";
  const Objectives objectives(session, 0, kViews);
  for (std::size_t a = 0; a < kParameters.size(); ++a) {
    for (std::size_t b = a + 1; b < kParameters.size(); ++b) {
      const PairOfParameters pair(objectives, a, b, steps);
      pair.WriteSurface(csv);
      pair.WriteHollows(&hollows);
      std::printf("surfaces: %s and %s\n", kParameters[a].c_str(), kParameters[b].c_str());
      std::fflush(stdout);
    }
  }
  if (!hollows.flush()) throw std::runtime_error("cannot write hollows.csv");
}

void Run(const std::string& what, int steps, std::uint64_t seed, const std::string& path) {
  if (what != "slices" && what != "surfaces") {
    throw std::runtime_error("expected slices or surfaces, not " + what);
  }
  std::ofstream csv(path);
  const PairedSession session = AnySession(seed);
  if (what == "slices") {
    WriteSlices(session, steps, &csv);
  } else {
    WriteSurfaces(session, steps, path, &csv);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(arguments[0], std::stoi(arguments[1]), std::stoull(arguments[2]),
                      arguments[3]);
  };
  return rgbdt::study::StudyMain({"study_objective", "slices|surfaces STEPS SEED CSV", 4, 4, run},
                                 argc, argv);
}
