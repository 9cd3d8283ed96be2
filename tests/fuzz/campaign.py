"""Runs the fuzz targets, measures what the kept inputs cover, and sums up; see scripts/fuzz."""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = ROOT / "tests/fuzz"
INPUT_S = 10  # that one may take, under sanitizers
MEMORY_MB, ALLOCATION_MB = 2560, 1200  # an image of 2^27 pixels of 8 bytes takes 1024
MOST_KEPT_BYTES = 10_000  # of a target's inputs that a campaign found
AIMS = {"crashes": ("<=", 0), "parser_line_coverage": (">=", 0.9), "slowest_input_s": ("<=", 1)}

# What takes bytes of unknown origin apart; a folder stands for its sources.
PARSERS = """
calib/model/image_codec.cc
calib/files/image_files.cc
calib/files/import/lens_file.cc calib/files/import/internal/yaml_tree.cc
calib/files/import/pairing.cc calib/files/name_keys.cc
calib/files/points/fused_reader.cc calib/files/points/map_files.cc calib/files/points/sweep_reader.cc
calib/files/points/internal/fused_comments.cc calib/files/points/internal/pcd_table.cc
calib/files/points/internal/ply_table.cc calib/files/points/internal/point_columns.cc
calib/files/points/internal/record_table.cc
calib/files/schema/calibration_file.cc calib/files/schema/proto_convert.cc
calib/files/schema/report_file.cc calib/files/schema/rig_file.cc
calib/files/schema/session_script.cc
calib/files/schema/text_proto.cc calib/files/schema/internal/device_convert.cc
calib/files/schema/internal/lens_convert.cc calib/files/schema/internal/lidar_convert.cc
calib/files/schema/internal/target_convert.cc
calib/files/session/truth_file.cc calib/files/session/view_reader.cc
calib/scan_assembly/sweep_chunks.cc calib/scan_assembly/sweep_collector.cc
services/bags/ services/bags/internal/
services/bus/bus_key.cc services/bus/log_reader.cc services/bus/signature.cc
services/bus/internal/datagram.cc
services/bus/internal/ordered_stream.cc services/bus/internal/partial_message.cc
services/bus/internal/reassembly.cc services/bus/internal/repair_message.cc
services/bus/internal/repaired_streams.cc services/bus/internal/sent_messages.cc
services/drivers/camera/gvcp_message.cc services/drivers/camera/internal/frame_format.cc
services/drivers/dynamixel/dynamixel_protocol.cc
services/drivers/hesai/hesai_packets.cc services/drivers/hesai/hesai_sensors.cc
services/drivers/spinning/spinning_sweeps.cc services/drivers/robosense/robosense_packets.cc
services/drivers/hokuyo/scip_protocol.cc
services/drivers/livox/livox_packets.cc services/drivers/livox/livox_sweeps.cc
services/drivers/ouster/ouster_metadata.cc services/drivers/ouster/ouster_packets.cc
services/drivers/ouster/ouster_sweeps.cc services/drivers/pcap/pcap_reader.cc
services/drivers/velodyne/velodyne_packets.cc
services/drivers/velodyne/velodyne_sweeps.cc
services/import/internal/cursor.h services/import/internal/foxglove_reader.cc
services/import/import_log.cc services/import/ros_messages.cc services/import/sensor_data.cc
services/import/survey.cc services/import/topics.cc
services/messages/check.cc services/messages/codec.cc services/messages/codec_calibration.cc
services/messages/codec_cloud.cc services/messages/codec_detection.cc
services/messages/codec_image.cc services/messages/codec_rgbdt_cloud.cc
services/messages/codec_scan.cc services/messages/codec_session.cc
services/messages/codec_target.cc services/messages/internal/codec_board.cc
services/messages/internal/image_file.cc services/messages/internal/layout.cc
services/messages/signature.cc
services/packets/bag_packets.cc services/drivers/packets/packet_sweeps.cc services/packets/recording.cc
viewer/server/internal/browser.cc viewer/server/internal/foxglove_client.cc
viewer/server/internal/foxglove_protocol.cc viewer/server/internal/http_answer.cc
viewer/server/internal/http_connection.cc viewer/server/internal/message.cc
viewer/server/internal/origin.cc viewer/server/internal/web_socket.cc
""".split()


def check_parsers():
    """One that was moved would count as covered."""
    for name in PARSERS:
        if not (ROOT / name).exists():
            sys.exit(f"fuzz: tests/fuzz/campaign.py names {name}, which is not there")


def parse_arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=int, required=True)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--keep", action="store_true")
    return parser.parse_args()


def targets_of(options):
    known = sorted(p.stem for p in HERE.glob("*.cc") if "LLVMFuzzerTestOneInput" in p.read_text()
                   and p.stem not in ("replay", "fuzz"))
    for name in options.only:
        if name not in known:
            sys.exit(f"fuzz: no target '{name}'; there are: {', '.join(known)}")
    return options.only or known


def environment(profile):
    """Scratch files in memory; a program of which no profile is wanted writes it nowhere."""
    env = dict(os.environ, LLVM_PROFILE_FILE=str(profile or "/dev/null"),
               ASAN_OPTIONS="quarantine_size_mb=32", UBSAN_OPTIONS="print_stacktrace=1")
    if os.access("/dev/shm", os.W_OK):
        env["TMPDIR"] = "/dev/shm"
    return env


class Target:
    def __init__(self, name, options):
        self.name = name
        self.program = options.build / "bin" / f"fuzz_{name}"
        out = options.out
        self.work, self.crashes = out / "work" / name, out / "crashes" / name
        self.log, self.profile = out / "logs" / f"{name}.log", out / "profiles" / f"{name}.profraw"
        self.kept = [out / "seeds" / name, HERE / "corpus" / name]
        self.executions, self.slowest_s, self.ended = 0, 0.0, 0
        for folder in (self.work, self.log.parent, self.profile.parent):
            folder.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(self.crashes, ignore_errors=True)
        self.crashes.mkdir(parents=True)

    def limits(self):
        return [f"-rss_limit_mb={MEMORY_MB}", f"-malloc_limit_mb={ALLOCATION_MB}",
                f"-timeout={INPUT_S}", f"-artifact_prefix={self.crashes}/", "-print_final_stats=1",
                "-report_slow_units=1"]

    def run(self, arguments, profile=None):
        with open(self.log, "a", encoding="utf-8") as log:
            done = subprocess.run([self.program, *self.limits(), *arguments], stdout=log, stderr=log,
                                  env=environment(profile), check=False)
        return done.returncode

    def kept_inputs(self):
        return sorted(f for folder in self.kept if folder.is_dir() for f in folder.iterdir())

    def run_each(self, files, profile=None):
        """Each by itself, with its time in the log. Gives the code, and how many ran."""
        begin = self.log.stat().st_size
        code = self.run([str(f) for f in files], profile)
        text = self.log.read_bytes()[begin:].decode(errors="replace")
        times = [int(ms) for ms in re.findall(r"^Executed .* in (\d+) ms$", text, re.M)]
        self.slowest_s = max([self.slowest_s] + [ms / 1000 for ms in times])
        return code, len(times)

    def replay(self):
        """The kept inputs; and their coverage."""
        self.log.write_text("")
        code, ran = self.run_each(self.kept_inputs(), self.profile)
        self.executions += ran
        self.ended += code != 0

    def fuzz(self, seconds):
        if seconds == 0:
            return
        folders = [str(f) for f in [self.work, *self.kept] if f.is_dir()]
        code = self.run([f"-max_total_time={seconds}", "-reload=0", *folders])
        text = self.log.read_text(errors="replace")
        self.executions += int((re.findall(r"number_of_executed_units: (\d+)", text) or [0])[-1])
        self.ended += code != 0
        # libFuzzer tells whole seconds, and what else ran may have been in the way: once more.
        if slow := sorted(self.crashes.glob("slow-unit-*")):
            self.run_each(slow)

    def keep(self):
        """Small inputs of the campaign that reach what no kept one does."""
        with tempfile.TemporaryDirectory() as folder:
            merged = pathlib.Path(folder)
            for file in self.kept_inputs():
                shutil.copy(file, merged / file.name)
            before = {f.name for f in merged.iterdir()}
            self.run(["-merge=1", "-use_counters=0", str(merged), str(self.work)])
            found = sorted((f for f in merged.iterdir() if f.name not in before),
                           key=lambda f: f.stat().st_size)
            corpus = HERE / "corpus" / self.name
            total = sum(f.stat().st_size for f in corpus.glob("*")
                        if not f.name.startswith("found-"))
            for file in found:
                total += file.stat().st_size
                if total > MOST_KEPT_BYTES:
                    break
                corpus.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, corpus / file.name[:16])


def measure(targets, options):
    """Lines of the parsers: (covered, all) by source."""
    profile = options.out / "profiles" / "all.profdata"
    raw = [t.profile for t in targets if t.profile.exists()]
    subprocess.run(["llvm-profdata", "merge", "-sparse", "-o", profile, *raw], check=True)
    command = ["llvm-cov", "export", "-summary-only", f"-instr-profile={profile}",
               str(targets[0].program)]
    for target in targets[1:]:
        command += ["-object", str(target.program)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    lines = {}
    for file in json.loads(done.stdout)["data"][0]["files"]:
        name = file["filename"].split("/main/")[-1] if not file["filename"].startswith(str(ROOT)) \
            else str(pathlib.Path(file["filename"]).relative_to(ROOT))
        folder = name[: name.rfind("/") + 1]
        if name in PARSERS or folder in PARSERS:
            summary = file["summary"]["lines"]
            lines[name] = (summary["covered"], summary["count"])
    return lines


def write_results(targets, lines, options):
    rows = [f"{'target':18}{'executions':>12}{'slowest [s]':>13}{'crashes':>9}"]
    for t in targets:
        rows.append(f"{t.name:18}{t.executions:12}{t.slowest_s:13.3f}{t.ended:9}")
    (options.out / "table.txt").write_text("\n".join(rows) + "\n")
    covered, count = (sum(x) for x in zip(*lines.values())) if lines else (0, 1)
    (options.out / "coverage.txt").write_text(
        "".join(f"{100 * c / max(n, 1):6.1f}% {c:5} of {n:5} {name}\n"
                for name, (c, n) in sorted(lines.items())))
    figures = [
        ("targets", len(targets), ""),
        ("executions", sum(t.executions for t in targets), ""),
        ("crashes", sum(t.ended for t in targets), ""),
        ("parser_lines", count, ""),
        ("parser_line_coverage", round(covered / count, 4), ""),
        ("slowest_input_s", max(t.slowest_s for t in targets), "s"),
    ]
    (options.out / "summary.json").write_text(json.dumps(
        {"figures": [{"name": n, "value": v, "unit": u} for n, v, u in figures]}, indent=1) + "\n")
    print("\n".join(rows))
    missed = []
    for name, value, unit in figures:
        aim, bound = AIMS.get(name, ("", value))
        good = value >= bound if aim == ">=" else value <= bound
        print(f"{name} {value} {unit}".rstrip() + (f" ({aim} {bound})" if aim else "") +
              ("" if good else " MISSED"))
        if not good:
            missed.append(name)
    return missed


def main():
    check_parsers()
    options = parse_arguments()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    seeds = subprocess.run([options.build / "bin/fuzz_seeds", options.out / "seeds"],
                           env=environment(None), check=False)
    if seeds.returncode != 0:
        sys.exit("fuzz: the inputs to begin with could not be written")
    targets = [Target(name, options) for name in targets_of(options)]

    def work(target):
        target.replay()
        target.fuzz(options.seconds)
        print(f"{target.name}: {target.executions} executions"
              + (f", ENDED; see {target.log}" if target.ended else ""), flush=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(work, targets))
        if options.keep:
            list(pool.map(Target.keep, targets))
    missed = write_results(targets, measure(targets, options), options)
    print(f"in {options.out}")
    # What single targets cover, and take on a machine that also does other things, is not judged.
    sys.exit(1 if "crashes" in missed or (missed and not options.only) else 0)


main()
