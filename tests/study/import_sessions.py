"""One session as folders and as a bag of each kind: is the calibration the same, bit for bit? And
what reading a large bag of each kind takes. Usage: import_sessions.py BIN_DIR OUT.csv VIEWS SECONDS"""

import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "cli"))
import make_bag  # noqa: E402

BOARD = "11x8@0.1,1.2192x0.9144"
KINDS = ("b.mcap:none", "b.mcap:zstd", "b.mcap:lz4", "b.db3:none", "b.db3:zstd", "b.bag:none",
         "b.bag:bz2", "b.bag:lz4")
MAKE_BAG = pathlib.Path(make_bag.__file__)
TRIES = 3  # of what is timed against copying: the best counts


def run(*command):
    """Seconds, and the most memory [MB] that it took."""
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as output:
        child = subprocess.Popen([str(word) for word in command], stdout=output, stderr=output)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            output.seek(0)
            sys.exit(f"{command[0]}: {output.read()[-500:]}")
    return time.monotonic() - begin, usage.ru_maxrss / 1024


def lens_file(path, lens):
    k = [lens["fx"], 0, lens["cx"], 0, lens["fy"], lens["cy"], 0, 0, 1]
    path.write_text(f"width: {lens['width']}\nheight: {lens['height']}\nK: {k}\nD: {lens['d']}\n"
                    "distortion_model: plumb_bob\n")
    return path


def folder_session(rgbdt, session, work):
    """Named by the times that the bags have."""
    lenses, views = make_bag.read_session(session)
    command = [rgbdt, "session", "--clouds", work / "pcd", "--board", BOARD, "--out", work / "folders"]
    for folder in ("pcd", *lenses):
        (work / folder).mkdir()
    for i, view in enumerate(views):
        seconds = make_bag.EPOCH_NS // 10**9 + i
        (work / f"pcd/{seconds}.000000.pcd").symlink_to(f"{view}/cloud.pcd")
        for camera in lenses:
            (work / camera / f"{seconds}.020000.png").symlink_to(f"{view}/{camera}.png")
    for camera, lens in lenses.items():
        command += ["--images", work / camera, "--lens", lens_file(work / f"{camera}.yaml", lens)]
    run(*command)
    return calibration(rgbdt, work / "folders")


def calibration(rgbdt, session):
    run(rgbdt, "calibrate", session)
    return (session / "calibration.textproto").read_bytes()


def best_copy(bag, work):
    """Seconds; out of the page cache, as the bag has just been read."""
    times = []
    for _ in range(TRIES):
        times.append(run("cp", "--reflink=never", "--sparse=never", bag, work / "copy")[0])
        run("rm", work / "copy")
    return min(times)


def best_import(tries, *command, out):
    """Seconds, of the best, and the most memory [MB] of any."""
    tried = []
    for _ in range(tries):
        tried.append(run(*command, "--out", out))
        run("rm", "-r", out)
    return min(seconds for seconds, _ in tried), max(memory for _, memory in tried)


def row_of(rgbdt, session, kind, expected, seconds, work):
    name, compression = kind.split(":")
    bag, out = work / name, work / "imported"
    run("python3", MAKE_BAG, session, f"{bag}:{compression}")
    run(rgbdt, "import", bag, "--board", BOARD, "--every", 1, "--out", out)
    same = calibration(rgbdt, out) == expected
    run("rm", "-r", out, bag)
    run("python3", MAKE_BAG, session, f"{bag}:{compression}", "--seconds", seconds)
    megabytes = bag.stat().st_size / 1e6
    run("sync", bag)
    list_s, _ = run(rgbdt, "import", bag)
    plain = compression == "none"
    import_s, rss_mb = best_import(TRIES if plain else 1, rgbdt, "import", bag, "--board", BOARD,
                                   "--every", seconds, out=out)
    copy_s = best_copy(bag, work) if plain else None
    run("rm", bag)
    return {"kind": re.sub(r"^b\.|:none", "", kind), "identical": int(same), "megabytes": megabytes,
            "list_s": list_s, "import_s": import_s, "copy_s": copy_s, "rss_mb": rss_mb}


def main():
    rgbdt, csv_path = f"{sys.argv[1]}/rgbdt", sys.argv[2]
    views, seconds = map(int, sys.argv[3:])
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        run(rgbdt, "simulate", work / "session", "--views", views, "--picked", "rgb")
        expected = folder_session(rgbdt, work / "session", work)
        rows = []
        for kind in KINDS:
            rows.append(row_of(rgbdt, work / "session", kind, expected, seconds, work))
            print(f"study: {len(rows)} of {len(KINDS)} kinds of bag done: {kind}", file=sys.stderr)
    with open(csv_path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0])
        writer.writeheader()
        writer.writerows(rows)


main()
