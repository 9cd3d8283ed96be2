"""One line for each calibrated session and camera: python3 summary.py OUT

Prints what calibrate_one wrote below OUT as tab-separated values, sessions by name: session, camera,
exit code, verdict, status, camera_from_lidar (quaternion w x y z, translation [m]) and 1 sigma of its
worst axis [deg, mm]. Figures that change from run to run (times) are left out."""

import json
import pathlib
import sys

HEAD = "session camera exit_code verdict status qw qx qy qz x_m y_m z_m sigma_deg sigma_mm".split()


def numbers(camera):
    """As report.json has them; nothing of a camera without a result."""
    if camera["status"] != "CONVERGED":
        return []
    pose, sigma = camera["camera_from_lidar"], camera["sigma"]
    values = pose["quaternion_wxyz"] + pose["translation_m"]
    return [f"{v:.6f}" for v in values] + [
        f"{sigma['worst_rotation_deg']:.4f}", f"{sigma['worst_centre_mm']:.2f}"]


def lines(folder):
    code = (folder / "exit_code").read_text().strip()
    report = folder / "report.json"
    if not report.exists():
        return [[folder.name, "", code, "", "no report; see its messages.txt"]]
    cameras = json.loads(report.read_text())["cameras"]
    return [[folder.name, name, code, camera["verdict"]["grade"], camera["status"], *numbers(camera)]
            for name, camera in sorted(cameras.items())]


def main():
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        sys.exit("summary.py: expected the folder that calibrate_one wrote to")
    print(*HEAD, sep="\t")
    for done in sorted(pathlib.Path(sys.argv[1]).glob("*/exit_code")):
        for line in lines(done.parent):
            print(*line, sep="\t")


if __name__ == "__main__":
    main()
