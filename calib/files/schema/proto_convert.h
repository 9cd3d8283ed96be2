#pragma once

// The pieces that several schemas share, to and from calib/model.

#include <google/protobuf/repeated_field.h>

#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/calibration.h"
#include "calib/model/image.h"
#include "calib/model/rigid3.h"

namespace rgbdt::text {

using Numbers = google::protobuf::RepeatedField<double>;

/// Throws InputError unless `numbers` are `count` finite numbers.
void RequireNumbers(const Numbers& numbers, int count, const Place& place,
                    const std::string& field);

/// Throws InputError unless `number` is finite.
void RequireFinite(double number, const Place& place, const std::string& field);

/// All throw InputError where counts are wrong, numbers are not finite, or the quaternion's norm is
/// more than 1e-3 away from 1.
Rigid3 ToRigid3(const proto::Pose& pose, const Place& place);
Rigid3 ToRigid3(const proto::RigidMotion& pose, const Place& place);
Matrix6d ToMatrix(const proto::Covariance& covariance, const Place& place);
/// Throws InputError for a number that is no status.
SolveStatus ToStatus(proto::SolveStatus status, const Place& place);

/// Both with a normalised quaternion.
void FromRigid3(const Rigid3& pose, proto::Pose* out);
void FromRigid3(const Rigid3& pose, proto::RigidMotion* out);
void FromMatrix(const Matrix6d& covariance, proto::Covariance* out);
proto::SolveStatus FromStatus(SolveStatus status);

/// Gain, offset and so on; emissivity and reflected temperature are the caller's.
Radiometry ToRadiometry(const proto::LinearRadiometry& linear, const Place& place);
Radiometry ToRadiometry(const proto::PlanckRadiometry& planck, const Place& place);
void FromLinear(const Radiometry& radiometry, proto::LinearRadiometry* out);
void FromPlanck(const Radiometry& radiometry, proto::PlanckRadiometry* out);

/// The quaternion with norm 1; one that has it already keeps its bits.
Eigen::Quaterniond Normalised(const Eigen::Quaterniond& q);

}  // namespace rgbdt::text
