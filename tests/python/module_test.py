"""import rgbdt against what the command line writes. Usage: module_test.py BIN_DIR"""
import filecmp
import gc
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import rgbdt

BIN = sys.argv.pop()
SCRATCH = tempfile.TemporaryDirectory(prefix="rgbdt-python-")
SESSION = os.path.join(SCRATCH.name, "session")
OUT = os.path.join(SCRATCH.name, "out")


def run(*words):
    subprocess.run([os.path.join(BIN, "rgbdt"), *words], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def setUpModule():
    run("simulate", SESSION, "--views", "6")
    run("calibrate", SESSION, "--out", OUT)
    run("fuse", SESSION, "--view", "0002", "--calibration", f"{OUT}/calibration.textproto", "--out", OUT)


def event(number, channel, data):
    name = channel.encode()
    return struct.pack(">IqqII", 0xEDA1DA01, number, 1000 + number, len(name), len(data)) + name + data


def without_clock(report):
    """Without how long its computing took."""
    if isinstance(report, dict):
        return {key: without_clock(value) for key, value in report.items()
                if key not in ("seconds", "detect_s")}
    return [without_clock(each) for each in report] if isinstance(report, list) else report


class Session(unittest.TestCase):
    def test_view_is_the_files(self):
        session = rgbdt.open_session(SESSION)
        self.assertEqual(session.views, [f"{i:04}" for i in range(1, 7)])
        view = session.view("0002")
        file = rgbdt.read_cloud(f"{SESSION}/views/0002/cloud.pcd")
        np.testing.assert_array_equal(view.cloud.points, file.points)
        self.assertEqual(view.cloud.points.dtype, np.float32)
        self.assertEqual(len(view.cloud), view.cloud.lines * view.cloud.beams)
        self.assertTrue(np.isfinite(view.cloud.points).all(1).any())
        shapes = {image.camera: (image.pixels.shape, image.pixels.dtype) for image in view.images}
        self.assertEqual(set(shapes), set(session.cameras))
        self.assertEqual(shapes["thermal"][1], np.uint16)

    def test_arrays_outlive_what_they_come_from_and_are_read_only(self):
        points = rgbdt.open_session(SESSION).view("0001").cloud.points
        pixels = rgbdt.open_session(SESSION).view("0001").images[0].pixels
        sums = np.nansum(points), pixels.sum()
        gc.collect()
        filler = [np.ones(points.shape, np.float32) for _ in range(20)]
        self.assertEqual((np.nansum(points), pixels.sum()), sums)
        del filler
        with self.assertRaises(ValueError):
            points[0, 0] = 1
        with self.assertRaises(ValueError):
            pixels[0, 0] = 1

    def test_bad_input_is_an_exception(self):
        self.assertTrue(issubclass(rgbdt.InputError, ValueError))
        with self.assertRaisesRegex(rgbdt.InputError, "nowhere"):
            rgbdt.open_session("/nowhere")
        with self.assertRaises(KeyError):
            rgbdt.open_session(SESSION).view("9999")
        with self.assertRaisesRegex(rgbdt.InputError, "calibration.textproto"):
            rgbdt.read_calibration(f"{SESSION}/calibration.textproto")
        with self.assertRaisesRegex(rgbdt.InputError, "best"):
            rgbdt.calibrate(SESSION, method="best")
        with self.assertRaisesRegex(rgbdt.InputError, "no view \"0009\""):
            rgbdt.calibrate(SESSION, without="0009")
        noise = os.path.join(SCRATCH.name, "noise.pcd")
        with open(noise, "wb") as file:
            file.write(b"\x89PNG\r\n")
        with self.assertRaisesRegex(rgbdt.InputError, "noise.pcd"):
            rgbdt.read_cloud(noise)


class Solve(unittest.TestCase):
    def test_the_same_bits_as_the_command_line(self):
        before = sorted(os.listdir(SESSION))
        lines = []
        result = rgbdt.calibrate(SESSION, progress=lines.append)
        self.assertEqual(sorted(os.listdir(SESSION)), before, "it wrote unasked")
        self.assertEqual(len(lines), 6)
        mine = os.path.join(SCRATCH.name, "mine")
        os.mkdir(mine)
        result.write(mine)
        self.assertTrue(filecmp.cmp(f"{mine}/calibration.textproto", f"{OUT}/calibration.textproto",
                                    shallow=False))
        written = without_clock(rgbdt.read_report(f"{OUT}/report.json"))
        self.assertEqual(without_clock(rgbdt.read_report(f"{mine}/report.json")), written)
        self.assertEqual(without_clock(result.report), written)

    def test_the_example_runs(self):
        example = os.path.join(os.path.dirname(__file__), "../../scripts/examples/python/fuse_session.py")
        said = subprocess.run([sys.executable, example, SESSION], check=True, capture_output=True,
                              text=True).stdout
        self.assertEqual(said.count("\nview "), 6)

    def test_a_progress_that_raises_is_thrown_on(self):
        def stop(_):
            raise RuntimeError("enough")
        with self.assertRaisesRegex(RuntimeError, "enough"):
            rgbdt.calibrate(SESSION, progress=stop)

    def test_poses_and_covariances(self):
        calibration = rgbdt.read_calibration(f"{OUT}/calibration.textproto")
        self.assertEqual(calibration.cameras, ["rgb", "thermal"])
        for name in calibration.cameras:
            camera = calibration[name]
            pose = camera.camera_from_lidar
            self.assertEqual(pose.shape, (4, 4))
            np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
            np.testing.assert_array_equal(pose[:3, 3], camera.translation_m)
            w, x, y, z = camera.quaternion_wxyz  # the first column, by hand
            np.testing.assert_allclose(
                pose[:3, 0], [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
                atol=1e-12)
            self.assertEqual(camera.covariance.shape, (6, 6))
            self.assertGreater(np.linalg.eigvalsh(camera.covariance)[0], 0)
            self.assertTrue(camera.converged, camera.status)
        with self.assertRaises(KeyError):
            calibration["front"]
        self.assertEqual(list(calibration), calibration.cameras)
        self.assertEqual(calibration.keys(), calibration.cameras)
        self.assertTrue("rgb" in calibration and "front" not in calibration)
        self.assertEqual({name: camera.camera for name, camera in calibration.items()},
                         {"rgb": "rgb", "thermal": "thermal"})

    def test_fused_is_the_file(self):
        calibration = rgbdt.read_calibration(f"{OUT}/calibration.textproto")
        cloud = rgbdt.fuse(rgbdt.open_session(SESSION).view("0002"), calibration)
        cloud.write_ply(f"{OUT}/mine.ply")
        self.assertTrue(filecmp.cmp(f"{OUT}/mine.ply", f"{OUT}/fused.ply", shallow=False))
        table = rgbdt.read_fused(f"{OUT}/fused.ply").to_numpy()
        np.testing.assert_array_equal(table["temperature"], cloud.temperature_k)
        np.testing.assert_array_equal(np.stack([table[c] for c in "xyz"], 1), cloud.points)
        self.assertTrue(np.isfinite(table["temperature"]).any())

    def test_another_rig_is_refused(self):
        calibration = rgbdt.read_calibration(f"{OUT}/calibration.textproto")
        other = os.path.join(SCRATCH.name, "other")
        subprocess.run(["cp", "-r", SESSION, other], check=True)
        with open(f"{other}/rig.textproto", encoding="utf-8") as file:
            text = file.read()
        with open(f"{other}/rig.textproto", "w", encoding="utf-8") as file:
            file.write(text.replace("fx: ", "fx: 1", 1))
        view = rgbdt.open_session(other).view("0001")
        with self.assertRaises(rgbdt.InputError):
            rgbdt.fuse(view, calibration)
        with self.assertWarnsRegex(UserWarning, "used anyway"):
            rgbdt.fuse(view, calibration, anyway=True)


class Logs(unittest.TestCase):
    def setUp(self):
        self.path = os.path.join(SCRATCH.name, "a.lcmlog")

    def write(self, *events):
        with open(self.path, "wb") as file:
            for i, (channel, data) in enumerate(events):
                file.write(event(i, channel, data))

    # Bytes that Python's lcm-gen made, decoded by C++.
    def test_what_python_encodes_cplusplus_decodes(self):
        cloud = rgbdt.cloud_t()
        cloud.utime = cloud.sweep_utime = 1_700_000_000_000_000
        cloud.organised, cloud.num_lines, cloud.num_beams, cloud.num_points = True, 1, 3, 3
        cloud.x_m, cloud.y_m, cloud.z_m = [1.5, 2.5, 3.5], [0.25, -1, 2], [0, 1, 2]
        cloud.intensity, cloud.utime_offset_us, cloud.ring = [0.5, 1, 0], [0, 10, 20], [3, 3, 3]
        self.write(("CLOUD", cloud.encode()))
        (heard,) = rgbdt.read_log(self.path)
        self.assertIs(heard.type, rgbdt.cloud_t)
        self.assertEqual(heard.utime, cloud.utime)
        arrays = heard.arrays()
        np.testing.assert_array_equal(arrays.points, np.array([cloud.x_m, cloud.y_m, cloud.z_m]).T)
        np.testing.assert_array_equal(arrays.ring, cloud.ring)
        np.testing.assert_array_equal(arrays.utime, np.add(cloud.utime, cloud.utime_offset_us))

    def test_what_is_damaged_or_anybodys_is_told(self):
        pose = rgbdt.pose_t().encode()
        self.write(("POSE", pose[:-3]), ("OTHER", b"12345678 of another program"), ("POSE", b""))
        damaged, *others = rgbdt.read_log(self.path)
        self.assertEqual(len(others), 2)
        for heard in (damaged, *others):
            with self.assertRaises(rgbdt.InputError):
                heard.message
        with self.assertRaises(rgbdt.InputError):
            damaged.arrays()
        for other in others:  # as LCM's own, with which each log begins
            self.assertIsNone(other.utime)
            self.assertIsNone(other.arrays())
        with self.assertRaises(rgbdt.InputError):
            rgbdt.read_log("/nowhere.lcmlog")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
