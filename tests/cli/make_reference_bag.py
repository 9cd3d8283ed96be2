"""Makes ROS 1 bags of a session's views by ROS itself (Debian's python3-rosbag, python3-sensor-msgs),
with the times and topics of make_bag.py. Usage: make_reference_bag.py SESSION BAG:COMPRESSION..."""
import os
import sys

import genpy
import rosbag
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from std_msgs.msg import Header

import make_bag


def time(ns):
    return genpy.Time(ns // 10**9, ns % 10**9)


def cloud(stamp_ns, path):
    fields, width, height, data = make_bag.read_pcd(path)
    described, data = make_bag.with_timestamps(fields, width * height, data)
    step = sum(size for _, _, size in fields)
    return PointCloud2(header=Header(stamp=time(stamp_ns), frame_id="lidar"), height=height,
                       width=width, fields=[PointField(*field, 1) for field in described],
                       point_step=step, row_step=step * width, data=data, is_dense=False)


def image(header, path):
    width, height, channels, sample, pixels = make_bag.unpack_png(path)
    return Image(header=header, height=height, width=width, step=width * channels * sample,
                 encoding="mono16" if sample == 2 else "mono8", data=pixels)


def camera_info(header, lens):
    k = [lens["fx"], 0, lens["cx"], 0, lens["fy"], lens["cy"], 0, 0, 1]
    return CameraInfo(header=header, height=lens["height"], width=lens["width"], K=k, D=lens["d"],
                      distortion_model="plumb_bob")


def main():
    lenses, views = make_bag.read_session(sys.argv[1])
    for argument in sys.argv[2:]:
        path, _, compression = argument.partition(":")
        with rosbag.Bag(path, "w", compression=compression) as bag:
            for i, view in enumerate(views):
                at = make_bag.EPOCH_NS + i * 10**9
                bag.write("/lidar/points", cloud(at, os.path.join(view, "cloud.pcd")),
                          time(at + 150_000_000))
                for camera, lens in lenses.items():
                    header = Header(stamp=time(at + 20_000_000), frame_id=camera + "_optical")
                    log = time(at + 70_000_000)
                    bag.write(f"/{camera}/camera_info", camera_info(header, lens), log)
                    path = os.path.join(view, camera + ".png")
                    bag.write(f"/{camera}/image_raw", image(header, path), log)


main()
