// report.json as the page reads it: calib/files/schema/report.proto. A field that is unknown is absent.
import type { RigidMotion } from "./poses";

export type SolveStatus =
  "NOT_SOLVED" | "UNDETERMINED" | "NOT_CONVERGED" | "DEGENERATE" | "FIRST_GUESS_KEPT" | "CONVERGED";

export interface PoseError { rotation_deg?: number; translation_mm?: number }
export interface TrainHeldout { train?: number; heldout?: number }

export interface CameraReport {
  camera_from_lidar?: RigidMotion;
  status?: SolveStatus;
  detail?: string; // of the status
  views?: { used?: string[]; heldout?: string[]; rejected?: { view: string; why: string }[]; warnings?: string[] };
  distance_transform_px?: TrainHeldout;
  edge_rms_px?: TrainHeldout;
  edge_rms_whitened?: TrainHeldout;
  first_guess_error?: PoseError;
  truth_error?: PoseError;
  seconds?: { detect_image?: number; detect_cloud?: number; solve?: number };
  view_quality?: {
    view: string; heldout?: boolean; distance_transform_px?: number; edge_rms_px?: number; edge_rms_whitened?: number;
  }[];
  other_starts?: {
    start: string; status?: SolveStatus; detail?: string; distance_transform_px?: number;
    from_result?: PoseError; truth_error?: PoseError;
  }[];
  range_offset_m?: { value?: number; sigma?: number };
  sigma?: {
    rotation_deg?: number[]; centre_mm?: number[];
    colouring?: { distance_m?: number; centre_px?: number; worst_px?: number }[];
  };
  nuisance?: { name: string; unit: string; estimate?: { value?: number; sigma?: number } }[];
  folds?: {
    heldout?: string[]; edge_rms_whitened?: number; misfit?: number; first_guess_misfit?: number; from_result?: PoseError;
  }[];
  halves?: { difference?: PoseError; chi2?: number };
}

export interface ReportMessage {
  method?: string;
  cameras?: Record<string, CameraReport>;
  rig_hash?: string;
  utime?: string; // [us]; int64 are strings
  closure?: { from: string; to: string; difference?: PoseError; sigma?: PoseError; chi2?: number }[];
}
