#!/usr/bin/env bash
# rgbdt import of a recording of a LIDAR's packets. Usage: import_packets_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
python3 "$(dirname "${BASH_SOURCE[0]}")/make_pcap.py" "$scratch/drive.pcap" "$scratch/os.json" 3
os=(--metadata "$scratch/os.json")
says_line() {  # WHAT LINE
  grep -qxF -- "$2" "$scratch/output" || complain "$1: no line '$2'"
}

accepts "a list" "$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}"
says_line "a list" "OS-1-16 at UDP port 7502: 96 packets, 3 sweeps, 10 Hz"
says_line "a list" "next: add --images, --lens, --board and --out, or --out alone for PCD files"
accepts "sweeps" "$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}" --out "$scratch/clouds"
says_line "sweeps" "wrote 3 PCD files to $scratch/clouds"
[ "$(find "$scratch/clouds" -name '[0-9]*.[0-9]*.pcd' | wc -l)" = 3 ] || complain "sweeps: not three files"
for file in "$scratch"/clouds/*; do
  grep -qa '^HEIGHT 16$' "$file" || complain "sweeps: not of 16 lines"
done

# The same packets in a bag, with a camera: each view's cloud is the recording's sweep, to the byte.
board=8x6@0.1,0.85x0.65
mkdir "$scratch/kept"
for bag in drive.mcap drive.bag; do
  python3 "$(dirname "${BASH_SOURCE[0]}")/make_packet_bag.py" "$scratch/drive.pcap" "$scratch/os.json" "$scratch/$bag"
  accepts "list of $bag" "$bin/rgbdt" import "$scratch/$bag"
  grep -q "^would take: lidar: /ouster/lidar_packets" "$scratch/output" || complain "$bag: packets not taken"
  for metadata in "" "$scratch/os.json"; do
    rm -rf "$scratch/session"
    accepts "$bag" "$bin/rgbdt" import "$scratch/$bag" ${metadata:+--metadata "$metadata"} --board "$board" \
      --every 0.1 --out "$scratch/session"
    says_line "$bag" "/ouster/lidar_packets: 96 packets of a OS-1-16, 3 sweeps"
    views=("$scratch"/session/views/*/cloud.pcd) clouds=("$scratch"/clouds/*)
    [ "${#views[@]}" = 3 ] || complain "$bag: ${#views[@]} views, not 3"
    for i in "${!views[@]}"; do
      cmp -s "${views[$i]}" "${clouds[$i]}" || complain "$bag: view $i is not the recording's sweep"
    done
  done
done
# Two LIDARs' packets are each decoded by what is said of that one.
python3 "$(dirname "${BASH_SOURCE[0]}")/make_packet_bag.py" "$scratch/drive.pcap" "$scratch/os.json" "$scratch/two.mcap" front rear
two=("$bin/rgbdt" import "$scratch/two.mcap" --board "$board" --every 0.1)
accepts "two LIDARs' packets" "${two[@]}" --metadata "rear=$scratch/os.json" --out "$scratch/two"
says_all "two LIDARs' packets" "lidar front (the reference): /front/lidar_packets" \
  "/rear/lidar_packets: 96 packets of a OS-1-16, 3 sweeps"
for i in 1 2 3; do
  cmp "$scratch/session/views/000$i/cloud.pcd" "$scratch/two/views/000$i/cloud_rear.pcd" ||
    complain "two LIDARs' packets: view $i has another cloud"
done
says=("NAME=FILE" "front, rear")
refuses "metadata of which LIDAR" "${two[@]}" --metadata "$scratch/os.json" --out "$scratch/kept/new"

says=("drive.pcap" "CSV" "JSON")
refuses "a bag with wrong metadata" "$bin/rgbdt" import "$scratch/drive.bag" --metadata "$scratch/drive.pcap" \
  --board "$board" --every 0.1 --out "$scratch/kept/new"
says=("--port")
misuses "a bag with a port" "$bin/rgbdt" import "$scratch/drive.bag" --port 7502

# Cut off: what lies before is taken.
head -c 200000 "$scratch/drive.pcap" >"$scratch/cut.pcap"
accepts "cut off" "$bin/rgbdt" import "$scratch/cut.pcap" "${os[@]}"
grep -q "^problem: $scratch/cut.pcap: is damaged or cut short" "$scratch/output" || complain "cut off: not told"

echo mine >"$scratch/kept/mine"
says=("--metadata" "7502")
refuses "no known LIDAR" "$bin/rgbdt" import "$scratch/drive.pcap" --out "$scratch/kept/new"
says=("not empty")
refuses "a folder with files" "$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}" --out "$scratch/kept"
says=("drive.pcap" "CSV" "JSON")
refuses "no metadata" "$bin/rgbdt" import "$scratch/drive.pcap" --metadata "$scratch/drive.pcap" --out "$scratch/kept/new"
says=("nowhere.pcap")
refuses "no file" "$bin/rgbdt" import "$scratch/nowhere.pcap"
mkfifo "$scratch/pipe.pcap"
says=("pipe.pcap" "regular file")
refuses "a pipe" "$bin/rgbdt" import "$scratch/pipe.pcap"
cp "$scratch/os.json" "$scratch/text.pcap"
says=("text.pcap" "pcap")
refuses "no recording" "$bin/rgbdt" import "$scratch/text.pcap"
says=("--images DIR")
misuses "a board without images" "$bin/rgbdt" import "$scratch/drive.pcap" --board 8x6@0.1,0.8x0.6 --out "$scratch/kept/new"
says=("--images" "--out")
misuses "images without a board" "$bin/rgbdt" import "$scratch/drive.pcap" --images "$scratch" --out "$scratch/kept/new"
says=("--images DIR")
misuses "a topic" "$bin/rgbdt" import "$scratch/drive.pcap" --cloud /points
says=("--images" ".pcap")
misuses "images beside a bag" "$bin/rgbdt" import "$scratch/drive.mcap" --images "$scratch"

# With images, called by their times, a session at once: of the sweeps that have one.
mkdir "$scratch/images"
for i in 0 2; do
  name=$(basename "${clouds[$i]}" .pcd)
  cp "$scratch/session/views/0001/cam.png" "$scratch/images/$name.png"
done
lens_of "$scratch/session/rig.textproto" cam >"$scratch/lens.yaml"
session=("$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}" --images left="$scratch/images"
  --lens "$scratch/lens.yaml" --board "$board")
accepts "a session" "${session[@]}" --out "$scratch/made"
says_line "a session" "OS-1-16 at UDP port 7502: 96 packets, 3 sweeps, 10 Hz"
says_all "a session" "2 views, paired by time" "camera left: colour" "1 cloud without an image" "next: rgbdt calibrate"
[ "$(ls "$scratch/made/clouds")" = "$(basename "${clouds[0]}"; basename "${clouds[2]}")" ] ||
  complain "a session: not the clouds of its two views"
for cloud in "$scratch"/made/clouds/*; do
  cmp "$cloud" "$scratch/clouds/$(basename "$cloud")" || complain "a session: another sweep"
done
grep -qF "made/clouds/$(basename "${clouds[2]}")" "$scratch/made/views/$(basename "${clouds[2]}" .pcd)/view.textproto" ||
  complain "a session: its view names another cloud"
says=("earlier session")
refuses "a session that is there" "${session[@]}" --out "$scratch/made"
says=("2 images" "3 clouds" "--in-order")
refuses "counts that differ" "${session[@]}" --in-order --out "$scratch/kept/new"
says=("--lens" "--pinhole")
refuses "no lens" "$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}" --images "$scratch/images" --board "$board" \
  --out "$scratch/kept/new"
sed 's/^image_width: .*/image_width: 99/' "$scratch/lens.yaml" >"$scratch/small.yaml"
says=("small.yaml" "99x")
refuses "another lens" "$bin/rgbdt" import "$scratch/drive.pcap" "${os[@]}" --images "$scratch/images" --board "$board" \
  --lens "$scratch/small.yaml" --out "$scratch/kept/new"
[ ! -e "$scratch/kept/new" ] || complain "another lens: something was written"

verdict
