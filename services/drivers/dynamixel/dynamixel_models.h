#pragma once

namespace rgbdt::dynamixel {

/// Where a series keeps what a turning motor needs. All in the ROBOTIS e-Manual, "Control Table".
struct ControlTable {
  struct Entry {
    int address = 0;
    int size = 0;  ///< [bytes]; 0: the series has no such entry
  };
  Entry return_delay;    ///< [2 us]
  Entry drive_mode;      ///< bit 2: profiles are given by times, not by speeds
  Entry operating_mode;  ///< 3: position, within the limits; 4: position, many turns
  Entry max_position, min_position;
  Entry torque_enable;
  Entry hardware_error;
  Entry acceleration, velocity;  ///< of the way to a goal position
  Entry goal_position, present_position;
};

struct Model {
  int number;  ///< as a ping brings it
  const char* name;
  const ControlTable* table;
  double ticks_per_turn;     ///< of the output shaft
  double velocity_unit;      ///< [turns of the output shaft / min]
  double acceleration_unit;  ///< [turns of the output shaft / min^2]
};

/// Null for a model that is not known.
const Model* FindModel(int number);

}  // namespace rgbdt::dynamixel
