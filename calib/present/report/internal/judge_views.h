#pragma once

#include "calib/model/calibration.h"
#include "calib/present/report/internal/judgement.h"

namespace rgbdt {

/// Whether the views fit together at all: before any figure that takes them to.
void JudgeAgreement(const CameraReport& camera, Judgement* judgement);

/// Whether the views scatter, or their edges and planes differ, by more than they state: the stated
/// sigma was enlarged for it, and why is worth a look.
bool ViewsDisagree(const CameraReport& camera);

/// Whether the boards, or the scene, lie in the images where the pose puts them: in pixels, on the
/// board in millimetres, and in their sigmas; halves, and edges against planes.
void JudgeResiduals(const CameraReport& camera, Judgement* judgement);

/// Whether so many views were rejected that it speaks against the result.
bool ManyAreRejected(const CameraReport& camera);

/// Without a pose: why views could not be used; what is alike is said once.
void JudgeRejections(const CameraReport& camera, Judgement* judgement);

}  // namespace rgbdt
