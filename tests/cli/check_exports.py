"""Reads what `rgbdt export DIR` wrote without anything of rgbdt, and holds it against
DIR/calibration.textproto. YAML is read by PyYAML where that is installed.
Usage: check_exports.py DIR"""
import math
import re
import sys
import xml.etree.ElementTree as xml

try:
    import yaml
except ImportError:
    yaml = None

session = sys.argv[1]
FRAMES = {"rgb": "camera_optical_frame", "thermal": "flir/optical"}


def read(path):
    with open(f"{session}/{path}", encoding="utf-8") as f:
        return f.read()


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))]
            for i in range(len(a))]


def turned(axis, angle):
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = [[float(r == c) for c in range(3)] for r in range(3)]
    matrix[i][i] = matrix[j][j] = math.cos(angle)
    matrix[i][j], matrix[j][i] = -math.sin(angle), math.sin(angle)
    return matrix


def by_quaternion(w, x, y, z):
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def inverse(rotation, t):
    transposed = [list(row) for row in zip(*rotation)]
    return transposed, [-sum(transposed[i][k] * t[k] for k in range(3)) for i in range(3)]


def numbers(text):
    return [float(n) for n in re.findall(r"[-+.\de]+", text)]


def expect(good, what):
    if not good:
        sys.exit(what)


truth = {}
for block in read("calibration.textproto").split("\ncamera {")[1:]:
    name = re.search(r'camera: "(\w+)"', block)[1]
    quaternion = numbers(re.search(r"quaternion_wxyz: \[(.*?)\]", block)[1])
    truth[name] = by_quaternion(*quaternion), numbers(re.search(r"translation_m: \[(.*?)\]", block)[1])


def compare(what, camera, rotation, t):
    expected, place = truth[camera]
    off = max(abs(rotation[i][j] - expected[i][j]) for i in range(3) for j in range(3))
    expect(off < 1e-9, f"{what}: {camera} is turned by {off}")
    off = max(abs(t[i] - place[i]) for i in range(3))
    expect(off < 1e-9, f"{what}: {camera} is {off} m off")


# The URDF: fixed axes, roll about x, then pitch about y, then yaw about z.
robot = xml.fromstring(read("export/cameras.urdf"))
links = [link.get("name") for link in robot.findall("link")]
expect(links == ["velodyne", *FRAMES.values()], f"links {links}")
for joint, camera in zip(robot.findall("joint"), truth, strict=True):
    expect(joint.get("type") == "fixed", "a joint that moves")
    expect(joint.find("parent").get("link") == "velodyne", "another parent")
    expect(joint.find("child").get("link") == FRAMES[camera], "another child")
    origin = joint.find("origin")
    roll, pitch, yaw = numbers(origin.get("rpy"))
    rotation = product(turned(2, yaw), product(turned(1, pitch), turned(0, roll)))
    compare("URDF", camera, *inverse(rotation, numbers(origin.get("xyz"))))


def publish(what, camera, words):
    given = dict(zip(words[::2], words[1::2], strict=True))
    expect(given.pop("--frame-id") == "velodyne", f"{what}: another parent")
    expect(given.pop("--child-frame-id") == FRAMES[camera], f"{what}: another child")
    n = {key[2:]: float(value) for key, value in given.items()}
    expect(sorted(n) == sorted(["x", "y", "z", "qx", "qy", "qz", "qw"]), f"{what}: {sorted(n)}")
    rotation = by_quaternion(n["qw"], n["qx"], n["qy"], n["qz"])
    compare(what, camera, *inverse(rotation, [n["x"], n["y"], n["z"]]))


lines = read("export/ros_static_transform.txt").splitlines()
for line, camera in zip([l for l in lines if l.startswith("ros2 ")], truth, strict=True):
    publish("command line of ROS 2", camera, line.split()[4:])
for line, camera in zip([l for l in lines if l.startswith("rosrun ")], truth, strict=True):
    *pose, parent, child = line.split()[3:]
    x, y, z, qx, qy, qz, qw = map(float, pose)
    expect((parent, child) == ("velodyne", FRAMES[camera]), "ROS 1: other frames")
    compare("command line of ROS 1", camera, *inverse(by_quaternion(qw, qx, qy, qz), [x, y, z]))

# MATLAB: matrices row by row, points behind them, pixels counted from 1.
function = read("export/matlab_calibration.m").replace("...\n", "")
expect(function.startswith("function cameras = matlab_calibration()\n"), "MATLAB: no such function")
for i, (camera, centre) in enumerate({"rgb": [960.5, 604.5], "thermal": [160.5, 128.5]}.items()):
    fields = dict(re.findall(rf"^cameras\({i + 1}\)\.(\w+) = (.*?);(?:  %.*)?$", function, re.M))
    expect(fields["name"] == f"'{camera}'", "MATLAB: another camera")
    rows = [numbers(row) for row in fields["camera_from_lidar"].strip("[] ").split(";")]
    expect(len(rows) == 4 and rows[3] == [0, 0, 0, 1], "MATLAB: no matrix of a pose")
    compare("MATLAB", camera, [row[:3] for row in rows[:3]], [row[3] for row in rows[:3]])
    expect(numbers(fields["principal_point"]) == centre, f"MATLAB: {fields['principal_point']}")
expect(numbers(fields["image_size"]) == [256, 320], "MATLAB: rows and columns")
expect(numbers(fields["fisheye"]) == [0.01, 0, 0, 0] and "radial" not in fields, "MATLAB: the lens")

# Autoware: fixed axes as the URDF's, of a camera_link: its x is the optical frame's z, its y and z
# the other's -x and -y. Two levels, numbers below them, so no YAML reader is needed.
kit = {}
for line in read("export/sensor_kit_calibration.yaml").splitlines():
    if line.strip().startswith("#"):
        continue
    key, _, value = line.partition(":")
    depth = len(key) - len(key.lstrip())
    if depth == 0:
        expect(key == "velodyne", f"Autoware: the parent is {key}")
    elif depth == 2:
        kit[key.strip()] = entry = {}
    else:
        entry[key.strip()] = float(value)
expect(list(kit) == ["camera_frame", "flir/optical_link"], f"Autoware: {list(kit)}")
for entry, camera in zip(kit.values(), truth, strict=True):
    expect(list(entry) == ["x", "y", "z", "roll", "pitch", "yaw"], f"Autoware: {list(entry)}")
    rotation = product(turned(2, entry["yaw"]), product(turned(1, entry["pitch"]), turned(0, entry["roll"])))
    optical = product(rotation, [[0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    compare("Autoware", camera, *inverse(optical, [entry["x"], entry["y"], entry["z"]]))

if yaml is None:
    print("no PyYAML: the YAML files are left to the unit tests")
    sys.exit(0)
for step, camera in zip(yaml.safe_load(read("export/ros2_static_transform.launch.yaml"))["launch"],
                        truth, strict=True):
    node = step["node"]
    expect((node["pkg"], node["exec"]) == ("tf2_ros", "static_transform_publisher"), "another node")
    publish("launch file", camera, node["args"].split())
chain = yaml.safe_load(read("export/kalibr_camchain.yaml"))
for i, camera in enumerate(truth):
    matrix = chain[f"cam{i}"]["T_cam_lidar"]
    compare("camchain", camera, [row[:3] for row in matrix[:3]], [row[3] for row in matrix[:3]])
(r0, t0), (r1, t1) = truth.values()
step = chain["cam1"]["T_cn_cnm1"]
compare("camchain's step", "thermal", product([row[:3] for row in step[:3]], r0),
        [sum(step[i][k] * t0[k] for k in range(3)) + step[i][3] for i in range(3)])
expect(yaml.safe_load(read("export/sensor_kit_calibration.yaml")) == {"velodyne": kit},
       "Autoware: YAML reads other numbers")
