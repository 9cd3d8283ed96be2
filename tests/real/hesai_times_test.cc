// When a Hesai's channels fire, against the "firetime correction files" that their maker publishes:
// the data set "hesai", the folder correction/firetime_correction of HesaiLidar_SDK_2.0.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "services/drivers/hesai/hesai_sensors.h"
#include "tests/figures.h"

namespace rgbdt::hesai {
namespace {

namespace fs = std::filesystem;

std::string FileOf(const std::string& model) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  return (fs::path(data == nullptr ? "" : data) / "hesai" /
          (model + "_Firetime Correction File.csv"))
      .string();
}

// The lines that begin with a number: numbers, NaN for "-".
std::vector<std::vector<double>> NumbersOf(const std::string& model) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(FileOf(model));
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    std::vector<double> row;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      row.push_back(field[0] == '-' && field.size() < 3 ? std::nan("") : std::atof(field.c_str()));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

const Sensor& Named(const std::string& name) {
  for (const Sensor& sensor : Sensors()) {
    if (sensor.name == name) return sensor;
  }
  throw std::out_of_range(name);
}

struct Compared {
  std::size_t times = 0, agree = 0;
  void Add(double us, double expected_us) {
    ++times;
    if (std::abs(us - expected_us) < 0.001 || (std::isnan(us) && std::isnan(expected_us))) ++agree;
  }
};

// Channel and time. The maker counts an XT's from its packet's stamp.
void Compare(const std::string& model, const std::string& name, double from_us, Compared* all) {
  const std::vector<std::vector<double>> rows = NumbersOf(model);
  for (const auto& row : rows) {
    if (row.size() < 2) continue;
    all->Add(from_us + FiringOf(Named(name), 0, false).us.at(static_cast<std::size_t>(row[0]) - 1),
             row[1]);
  }
}

// Channel, and by state of high resolution (4) and of standard resolution (2) the time in ns, far
// and near. 0, where it does not fire.
void Compare128E3X(Compared* all) {
  const Sensor& sensor = Named("Pandar128E3X");
  for (const auto& row : NumbersOf("Pandar128E3X")) {
    if (row.size() < 13) continue;
    const auto channel = static_cast<std::size_t>(row[0]) - 1;
    for (std::size_t k = 0; k < 6; ++k) {
      const Firing firing = FiringOf(sensor, k < 4 ? k : k - 4, k < 4);
      for (const std::size_t near : {0, 1}) {
        const double ns = row[1 + 2 * k + near];
        all->Add((near == 1 ? firing.near_us : firing.us).at(channel),
                 ns == 0 ? std::nan("") : 1e-3 * ns);
      }
    }
  }
}

// Channel, and by state as above the time in us.
void CompareOt128(Compared* all) {
  for (const auto& row : NumbersOf("OT128")) {
    if (row.size() < 7) continue;
    for (std::size_t k = 0; k < 6; ++k) {
      all->Add(FiringOf(Named("OT128"), k < 4 ? k : k - 4, k < 4)
                   .us.at(static_cast<std::size_t>(row[0]) - 1),
               row[1 + k]);
    }
  }
}

// Channel and time in the first loop, the same in the second.
void CompareQt128(Compared* all) {
  for (const auto& row : NumbersOf("QT128C2X")) {
    if (row.size() < 4 || row[1] == 0) continue;
    for (const std::size_t loop : {0, 1}) {
      all->Add(FiringOf(Named("PandarQT-128"), loop, false)
                   .us.at(static_cast<std::size_t>(row[2 * loop]) - 1),
               row[2 * loop + 1]);
    }
  }
}

TEST(HesaiReal, ChannelsFireWhenTheMakersFilesSay) {
  if (!fs::exists(FileOf("OT128"))) {
    GTEST_SKIP() << "no hesai in RGBDT_REAL_DATA: firing times not compared";
  }
  Compared all;
  Compare("Pandar40P", "Pandar40P", 0, &all);
  Compare("Pandar64", "Pandar64", 0, &all);
  Compare("PandarQT", "PandarQT-64", 0, &all);
  Compare("PandarXT-16", "PandarXT-16", 5.632, &all);
  Compare("PandarXT-32", "PandarXT-32", 5.632, &all);
  Compare("PandarXT-32M2X", "PandarXT-32M", 5.632, &all);
  Compare128E3X(&all);
  CompareOt128(&all);
  CompareQt128(&all);
  TellShare("hesai_times_agree", all.agree, all.times);
  TellFigure("hesai_times", static_cast<double>(all.times));
  EXPECT_EQ(all.times, 2744U);
  EXPECT_EQ(all.agree, all.times);
}

}  // namespace
}  // namespace rgbdt::hesai
