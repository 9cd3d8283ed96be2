"""Calibrates a session and prints what each view's fused cloud holds.
Usage: PYTHONPATH=build/python /usr/bin/python3 scripts/examples/python/fuse_session.py SESSION"""
import sys

import numpy as np

import rgbdt

session = rgbdt.open_session(sys.argv[1])
result = rgbdt.calibrate(session.root)
for name in result.calibration.cameras:
    camera = result.calibration[name]
    print(f"{name}: {camera.status}\n{camera.camera_from_lidar}")
    if camera.covariance is not None:
        print("1 sigma about the camera's axes [deg]:",
              np.degrees(np.sqrt(np.diag(camera.covariance)[:3])))
for name in session.views:
    points = rgbdt.fuse(session.view(name), result.calibration).to_numpy()
    warmest = np.nanmax(points["temperature"], initial=0)
    print(f"view {name}: {len(points)} points, {np.mean(points['valid'] != 0):.0%} coloured, "
          f"the warmest has {warmest - 273.15:.1f} C")
