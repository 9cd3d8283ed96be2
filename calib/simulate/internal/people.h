#pragma once

#include <vector>

#include "calib/model/rigid3.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// Appends a person who stands at (x, y) [m] and faces the LIDAR. `temperature` [K]: of clothing.
void AddPerson(double x, double y, double ground_z, double temperature,
               std::vector<SceneObject>* objects);

/// Who holds the board (HolderOptions): hands that reach over its border, and a person behind it.
/// LIDAR frame; empty where the options ask for nobody.
std::vector<SceneObject> MakeHands(const Options& options, const Rigid3& lidar_from_target);

}  // namespace rgbdt::simulate
