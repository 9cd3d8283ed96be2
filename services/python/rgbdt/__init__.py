"""rgbdt: where colour and thermal cameras sit relative to a LIDAR, and the cloud that they fuse.

    import rgbdt
    session = rgbdt.open_session("out/demo/session")
    result = rgbdt.calibrate(session.root)
    print(result.calibration["rgb"].camera_from_lidar)      # 4x4
    cloud = rgbdt.fuse(session.view("0001"), result.calibration)
    print(cloud.points.shape, cloud.temperature_k)

Units are metres, radians, kelvin and microseconds (utime: int64, since 1970, UTC). LIDAR frame: x
forward, y left, z up; camera frame: x right, y down, z forward; pixel centres at integers. A pose
is named a_from_b: point_in_a = a_from_b @ point_in_b.

Arrays share the memory of the object that they come from, keep it alive and are read-only: copy()
what is to be changed. What cannot be used raises InputError, a ValueError whose text is for a
person.

The LCM types of rgbdt's bus are here, too, as lcm-gen makes them: rgbdt.cloud_t, rgbdt.image_t, ...
"""
import json as _json

import numpy as _np

from . import _core
from ._core import (Calibration, CameraCalibration, Cloud, FusedCloud, Image, InputError, Lens,
                    Session, View, __version__, open_session, read_calibration, read_cloud,
                    read_fused)
from ._lcm_types import *  # noqa: F401,F403
from .logs import LogEvent, read_log


class Calibrated:
    """What calibrate() found; nothing of it is on disk until write() is called."""

    def __init__(self, native):
        self._native = native
        self.calibration = native.calibration
        self.report = _json.loads(native.report_json)
        self.unreadable = native.unreadable

    def write(self, directory):
        """calibration.textproto (unless no camera was solved) and report.json, as `rgbdt calibrate`
        writes them, into a directory that is there. Files of these names are replaced."""
        if len(self.calibration) > 0:
            self.calibration.write(f"{directory}/calibration.textproto")
        self._native.write_report(f"{directory}/report.json")


def calibrate(dir, method="auto", without=(), progress=None):
    """Calibrates a session directory as `rgbdt calibrate DIR` does, to the bit.

    method: "auto", "plane", "paper", ...; without: names of views that are left out; progress: is
    called with a line for each view. Returns a Calibrated: `calibration`, `report` (a dict, as in
    report.json) and `unreadable` (a line for each view that could not be read). A camera whose
    solve did not converge says so in its status, and its verdict stands in the report: look at
    both. Raises InputError. Threads go on meanwhile."""
    without = {without} if isinstance(without, str) else set(without)
    return Calibrated(_core.calibrate(dir, method, without, progress))


def fuse(view, calibration, anyway=False):
    """Colours a view's cloud with its images: a FusedCloud, as `rgbdt fuse` writes it.

    A calibration that is not to be used, or was made with another rig, raises InputError; with
    `anyway` it is used all the same, and a UserWarning says what speaks against it."""
    return _core.fuse(view, calibration, anyway)


def read_report(path):
    """A report.json as a dict, checked against its schema and printed by Protobuf's own JSON:
    64-bit integers are strings, what is unknown is absent."""
    return _json.loads(_core.read_report_json(path))


_FUSED = _np.dtype([("x", "f4"), ("y", "f4"), ("z", "f4"), ("red", "u1"), ("green", "u1"),
                    ("blue", "u1"), ("intensity", "f4"), ("utime", "i8"), ("temperature", "f4"),
                    ("temperature_sigma", "f4"), ("thermal_counts", "f4"), ("valid", "u4")])


def _to_numpy(self):
    """A structured array of its own, a record a point; names, units and order as in fused.ply."""
    out = _np.empty(len(self), _FUSED)
    for names, columns in ((("x", "y", "z"), self.points), (("red", "green", "blue"), self.rgb)):
        for i, name in enumerate(names):
            out[name] = columns[:, i]
    for name in ("intensity", "utime", "thermal_counts", "valid"):
        out[name] = getattr(self, name)
    out["temperature"] = self.temperature_k
    out["temperature_sigma"] = self.temperature_sigma_k
    return out


FusedCloud.to_numpy = _to_numpy
