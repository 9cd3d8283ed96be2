#include "services/drivers/dynamixel/dynamixel_models.h"

namespace rgbdt::dynamixel {
namespace {

// Dynamixel Pro, e-Manual H54-200-S500-R. Present Position lies at an odd address: it is so.
constexpr ControlTable kPro = {
    {9, 1},    // Return Delay Time
    {},        // no Drive Mode
    {11, 1},   // Operating Mode
    {36, 4},   // Max Position Limit
    {40, 4},   // Min Position Limit
    {562, 1},  // Torque Enable
    {892, 1},  // Hardware Error Status
    {606, 4},  // Goal Acceleration
    {600, 4},  // Goal Velocity
    {596, 4},  // Goal Position
    {611, 4},  // Present Position
};

// X series and MX with Protocol 2.0, e-Manual XM540-W270.
constexpr ControlTable kX = {
    {9, 1},    // Return Delay Time
    {10, 1},   // Drive Mode
    {11, 1},   // Operating Mode
    {48, 4},   // Max Position Limit
    {52, 4},   // Min Position Limit
    {64, 1},   // Torque Enable
    {70, 1},   // Hardware Error Status
    {108, 4},  // Profile Acceleration
    {112, 4},  // Profile Velocity
    {116, 4},  // Goal Position
    {132, 4},  // Present Position
};

// P series, formerly Pro+, e-Manual PH54-200-S500-R and PM54-060-S250-R.
constexpr ControlTable kP = {
    {9, 1},    // Return Delay Time
    {10, 1},   // Drive Mode
    {11, 1},   // Operating Mode
    {48, 4},   // Max Position Limit
    {52, 4},   // Min Position Limit
    {512, 1},  // Torque Enable
    {518, 1},  // Hardware Error Status
    {556, 4},  // Profile Acceleration
    {560, 4},  // Profile Velocity
    {564, 4},  // Goal Position
    {580, 4},  // Present Position
};

// The Pro counts the speed of the motor before its gears: [turns/min] a unit and [turns/min^2].
constexpr Model Pro(int number, const char* name, double ticks_per_turn, double scale_factor) {
  return {number, name, &kPro, ticks_per_turn, scale_factor, 58'000 * scale_factor};
}

constexpr Model X(int number, const char* name) {
  return {number, name, &kX, 4096, 0.229, 214.577};
}

constexpr Model P(int number, const char* name, double ticks_per_turn) {
  return {number, name, &kP, ticks_per_turn, 0.01, 1};
}

constexpr Model kModels[] = {
    Pro(54024, "H54-200-S500-R", 501'923, 0.00199234),
    Pro(53768, "H54-100-S500-R", 501'923, 0.00199234),
    Pro(51200, "H42-20-S300-R", 303'750, 0.00329218),
    Pro(46352, "M54-60-S250-R", 251'417, 0.00397746),
    Pro(46096, "M54-40-S250-R", 251'417, 0.00397746),
    Pro(43288, "M42-10-S260-R", 263'187, 0.00389076),
    Pro(38176, "L54-50-S290-R", 207'692, 0.00346667),
    Pro(38152, "L54-50-S500-R", 361'384, 0.00199234),
    Pro(37896, "L54-30-S500-R", 361'384, 0.00199234),
    Pro(37928, "L54-30-S400-R", 288'395, 0.00249657),
    P(2020, "PH54-200-S500-R", 1'003'846),
    P(2010, "PH54-100-S500-R", 1'003'846),
    P(2000, "PH42-020-S300-R", 607'500),
    P(2120, "PM54-060-S250-R", 502'834),
    P(2110, "PM54-040-S250-R", 502'834),
    P(2100, "PM42-010-S260-R", 526'374),
    X(1000, "XH430-W350"),
    X(1010, "XH430-W210"),
    X(1020, "XM430-W350"),
    X(1030, "XM430-W210"),
    X(1040, "XH430-V350"),
    X(1050, "XH430-V210"),
    X(1060, "XL430-W250"),
    X(1070, "XC430-W150"),
    X(1080, "XC430-W240"),
    X(1100, "XH540-W270"),
    X(1110, "XH540-W150"),
    X(1120, "XM540-W270"),
    X(1130, "XM540-W150"),
    X(1140, "XH540-V270"),
    X(1150, "XH540-V150"),
    X(1170, "XW540-T260"),
    X(1180, "XW540-T140"),
    X(1270, "XW430-T333"),
    X(1280, "XW430-T200"),
};

}  // namespace

const Model* FindModel(int number) {
  for (const Model& model : kModels) {
    if (model.number == number) return &model;
  }
  return nullptr;
}

}  // namespace rgbdt::dynamixel
