#!/usr/bin/env bash
# What only the solve could tell outlives `evaluate`, as long as the poses are the same.
# Usage: evaluate_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

accepts "a session" "$bin/rgbdt" simulate "$scratch/s" --views 5
accepts "calibrating it" "$bin/rgbdt" calibrate "$scratch/s"

# As the solve would have told it.
cat >"$scratch/tell.py" <<'EOF'
import json, sys
path = sys.argv[1]
report = json.load(open(path))
error = {"rotation_deg": 0.0625, "translation_mm": 1.25}
pose = {"quaternion_wxyz": [1, 0, 0, 0], "translation_m": [0, 0, 0.5]}
for camera in report["cameras"].values():
    camera["sigma"] = {"rotation_deg": [0.01, 0.02, 0.03], "centre_mm": [0.4, 0.5, 0.6],
                       "colouring": [{"distance_m": 5, "centre_px": 0.1, "worst_px": 0.375}]}
    camera["nuisance"] = [{"name": "thickness", "unit": "mm", "estimate": {"value": 1, "sigma": 2}}]
    camera["folds"] = [{"heldout": ["0001"], "edge_rms_whitened": 1, "misfit": 1,
                        "first_guess_misfit": 1, "from_result": error}]
    camera["halves"] = {"difference": error, "chi2": 4}
report["closure"] = [{"from": "rgb", "to": "thermal", "to_from_from_by_lidar": pose,
                      "to_from_from_by_images": pose, "difference": error, "sigma": error,
                      "chi2": 5}]
report["next_view"] = {"words": "Hold the board 6 m ahead.", "lidar_from_target": pose,
                       "camera": "rgb", "sigma_before_px": 0.5, "sigma_after_px": 0.25}
json.dump(report, open(path, "w"))
EOF
cat >"$scratch/told.py" <<'EOF'
import json, sys
report = json.load(open(sys.argv[1]))
words = [f"{name}.{key}" for name, camera in report["cameras"].items()
         for key in ("sigma", "nuisance", "folds", "halves") if camera.get(key)]
print(*words, *(key for key in ("closure", "next_view") if report.get(key)))
EOF

tells() {  # WHAT FILE WORDS: the report has these parts of the solve's, and no others
  python3 "$scratch/told.py" "$2" >"$scratch/output" 2>&1 || complain "$1: no report"
  [ "$(cat "$scratch/output")" = "$3" ] || complain "$1: expected '$3'"
}

thermal="thermal.sigma thermal.nuisance thermal.folds thermal.halves"
all="rgb.sigma rgb.nuisance rgb.folds rgb.halves $thermal closure next_view"
python3 "$scratch/tell.py" "$scratch/s/report.json"
accepts "the same poses" "$bin/rgbdt" evaluate "$scratch/s" --out "$scratch"
grep -q -- "- / 0.38 / -" "$scratch/output" || complain "the table lacks the sigma of a projection"
grep -q "next view: Hold the board 6 m ahead." "$scratch/output" || complain "no next view"
tells "the same poses" "$scratch/report.json" "$all"
# In the plain page, or in the viewer's.
grep -Eq 'rgb: projection uncertainty|data-topic="image/sigma/rgb"' "$scratch/report.html" ||
  complain "no picture of the sigma"

# One camera moved: what was said of it, and of both together, is said of another pose.
awk '/translation_m:/ && !moved { sub(/: .*/, ": [0.01, 0.2, 0.03]"); moved = 1 } { print }' \
  "$scratch/s/calibration.textproto" >"$scratch/moved.textproto"
ends_with 4 "a moved camera" "$bin/rgbdt" evaluate "$scratch/s" --out "$scratch" \
  --calibration "$scratch/moved.textproto"
tells "a moved camera" "$scratch/report.json" "rgb.sigma $thermal"

# A calibration from elsewhere: what its own solve has found counts, not what the session's has.
mkdir "$scratch/elsewhere"
cp "$scratch/s/calibration.textproto" "$scratch/elsewhere"
python3 - "$scratch/s/report.json" "$scratch/elsewhere/report.json" <<'EOF'
import json, sys
report = json.load(open(sys.argv[1]))
report["cameras"]["rgb"]["causes"] = [{"name": "squares", "words": "the squares are 3% smaller",
                                       "chi2": 100, "freedom": 1, "moves_sigma": 3}]
json.dump(report, open(sys.argv[2], "w"))
EOF
elsewhere=(--calibration "$scratch/elsewhere/calibration.textproto" --out "$scratch/elsewhere/by_s")
ends_with 3 "doubts of its solve" "$bin/rgbdt" evaluate "$scratch/s" "${elsewhere[@]}"
grep -q "Likeliest cause: the squares are 3% smaller" "$scratch/output" ||
  complain "what the calibration's own solve has found is lost"
rm "$scratch/elsewhere/report.json" "$scratch/s/report.json"
accepts "no report of its solve" "$bin/rgbdt" evaluate "$scratch/s" "${elsewhere[@]}"
grep -q "Usable. Beside the calibration lies no report of its solve" "$scratch/output" ||
  complain "nothing says that the solve's own findings are not known"

verdict
