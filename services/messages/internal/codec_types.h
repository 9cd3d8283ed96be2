#pragma once

// Inside the codec: what each message's pair of conversions looks like. For every struct S of
// `Message` and its LCM type W:
//   W ToWire(const S&)     copies; throws InputError where vectors differ in length
//   void Check(const W&)   rules, the same when sending and when receiving (check.h); seq apart
//   S FromWire(const W&)   after Check; by value where the struct takes over long vectors
// ToWire guards sizes before it allocates: no array is longer than a message has bytes.

#include <lcmtypes/rgbdt/calibration_t.hpp>
#include <lcmtypes/rgbdt/cloud_t.hpp>
#include <lcmtypes/rgbdt/corner_selection_t.hpp>
#include <lcmtypes/rgbdt/encoder_t.hpp>
#include <lcmtypes/rgbdt/image_t.hpp>
#include <lcmtypes/rgbdt/left_out_views_t.hpp>
#include <lcmtypes/rgbdt/line_scan_t.hpp>
#include <lcmtypes/rgbdt/mount_check_t.hpp>
#include <lcmtypes/rgbdt/odometry_t.hpp>
#include <lcmtypes/rgbdt/pose_t.hpp>
#include <lcmtypes/rgbdt/report_t.hpp>
#include <lcmtypes/rgbdt/rgbdt_cloud_t.hpp>
#include <lcmtypes/rgbdt/rig_t.hpp>
#include <lcmtypes/rgbdt/session_command_t.hpp>
#include <lcmtypes/rgbdt/session_event_t.hpp>
#include <lcmtypes/rgbdt/session_request_t.hpp>
#include <lcmtypes/rgbdt/status_t.hpp>
#include <lcmtypes/rgbdt/target_status_t.hpp>
#include <lcmtypes/rgbdt/view_detection_t.hpp>
#include <lcmtypes/rgbdt/wave_progress_t.hpp>

#include "services/messages/message.h"

namespace rgbdt {

// codec_scan.cc
line_scan_t ToWire(const LineScan& line);
void Check(const line_scan_t& wire);
LineScan FromWire(const line_scan_t& wire);
encoder_t ToWire(const EncoderReading& reading);
void Check(const encoder_t& wire);
EncoderReading FromWire(const encoder_t& wire);

// codec_image.cc
image_t ToWire(const Image& image);
void Check(const image_t& wire);
Image FromWire(const image_t& wire);

// codec_cloud.cc
cloud_t ToWire(const CloudChunk& chunk);
void Check(const cloud_t& wire);
CloudChunk FromWire(const cloud_t& wire);

// codec_rgbdt_cloud.cc
rgbdt_cloud_t ToWire(const RgbdtCloud& cloud);
void Check(const rgbdt_cloud_t& wire);
RgbdtCloud FromWire(rgbdt_cloud_t wire);

// codec_target.cc
corner_selection_t ToWire(const CornerSelection& selection);
void Check(const corner_selection_t& wire);
CornerSelection FromWire(const corner_selection_t& wire);
target_status_t ToWire(const TargetStatus& status);
void Check(const target_status_t& wire);
TargetStatus FromWire(const target_status_t& wire);

// codec_detection.cc
view_detection_t ToWire(const ViewDetection& detection);
void Check(const view_detection_t& wire);
ViewDetection FromWire(const view_detection_t& wire);

// codec_calibration.cc
solved_lens_t ToWire(const SolvedLens& lens);
void Check(const solved_lens_t& wire);
SolvedLens FromWire(const solved_lens_t& wire);
range_errors_t ToWire(const RangeErrors& errors);
void Check(const range_errors_t& wire);
RangeErrors FromWire(const range_errors_t& wire);
camera_timing_t ToWire(const CameraTiming& timing);
void Check(const camera_timing_t& wire);
CameraTiming FromWire(const camera_timing_t& wire);
calibration_t ToWire(const CalibrationMessage& message);
void Check(const calibration_t& wire);
CalibrationMessage FromWire(const calibration_t& wire);
mount_check_t ToWire(const MountCheck& check);
void Check(const mount_check_t& wire);
MountCheck FromWire(const mount_check_t& wire);
pose_t ToWire(const StampedPose& pose);
void Check(const pose_t& wire);
StampedPose FromWire(const pose_t& wire);
odometry_t ToWire(const SweepOdometry& odometry);
void Check(const odometry_t& wire);
SweepOdometry FromWire(const odometry_t& wire);

// codec_wave.cc
waved_clock_t ToWire(const WavedClock& clock);
void Check(const waved_clock_t& wire);
WavedClock FromWire(const waved_clock_t& wire);
wave_progress_t ToWire(const WaveProgress& progress);
void Check(const wave_progress_t& wire);
WaveProgress FromWire(const wave_progress_t& wire);

// codec_session.cc
rig_t ToWire(const RigText& rig);
void Check(const rig_t& wire);
RigText FromWire(const rig_t& wire);
session_command_t ToWire(const SessionCommand& command);
void Check(const session_command_t& wire);
SessionCommand FromWire(const session_command_t& wire);
session_event_t ToWire(const SessionEvent& event);
void Check(const session_event_t& wire);
SessionEvent FromWire(const session_event_t& wire);
session_request_t ToWire(const SessionRequest& request);
void Check(const session_request_t& wire);
SessionRequest FromWire(const session_request_t& wire);
left_out_views_t ToWire(const LeftOutViews& left_out);
void Check(const left_out_views_t& wire);
LeftOutViews FromWire(const left_out_views_t& wire);
status_t ToWire(const Status& status);
void Check(const status_t& wire);
Status FromWire(const status_t& wire);
report_t ToWire(const ReportText& report);
void Check(const report_t& wire);
ReportText FromWire(const report_t& wire);

}  // namespace rgbdt
