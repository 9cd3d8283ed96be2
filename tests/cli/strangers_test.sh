#!/usr/bin/env bash
# Files that a stranger made: each is told in one line, in little time and memory, whatever its name,
# and nothing outside a session's directory is changed. Usage: strangers_test.sh BIN_DIR
set -euo pipefail
# shellcheck source=tests/cli/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
export LC_ALL=C.UTF-8

good=$scratch/good
accepts "a good session" "$bin/rgbdt" simulate "$good" --views 4 --seed 3
mkdir "$scratch/kept"

# A command in 4 GB of memory and 60 s of a core.
limited() { bash -c 'ulimit -v 4000000 -t 60; exec "$@"' limited "$@"; }
export -f limited
bounded=(bash -c 'limited "$@"' bounded)

# One line for a person: no line break in it, nothing that moves a terminal's cursor or turns text
# about.
one_line() { # WHAT
  [ "$(wc -l <"$scratch/output")" -eq 1 ] || complain "$1: not one line"
  harmless "$1"
}
harmless() { # WHAT
  if LC_ALL=C grep -q '[[:cntrl:]]' <(tr -d '\n\t' <"$scratch/output"); then
    complain "$1: control characters"
  fi
  if grep -qP '[\x{80}-\x{9f}\x{2028}-\x{202e}\x{2066}-\x{2069}]' "$scratch/output"; then
    complain "$1: control characters beyond ASCII"
  fi
  iconv -f utf-8 -t utf-8 "$scratch/output" >"$scratch/utf8" 2>&1 || complain "$1: no UTF-8"
}

# Of nothing, of holes, and of holes behind the head that each kind of file has. None is read whole.
declare -A head=(
  [x.lcmlog]='\xed\xa1\xda\x01'
  [x.mcap]='\x89MCAP0\r\n'
  [x.bag]='#ROSBAG V2.0\n'
  [x.db3]='SQLite format 3\0'
  [x.pcap]='\xd4\xc3\xb2\xa1\x02\0\x04\0\0\0\0\0\0\0\0\0\xff\xff\0\0\x01\0\0\0'
)
command_of() { # FILE: how rgbdt reads it
  case $1 in
    *.lcmlog) command=(replay "$1" --out "$scratch/kept/x") ;;
    *.pcap) command=(import "$1" --out "$scratch/kept/x") ;;
    *) command=(import "$1") ;;
  esac
}
for file in "${!head[@]}"; do
  for what in empty holes head; do
    path=$scratch/$file
    : >"$path"
    # shellcheck disable=SC2059 # a head is a format
    [ "$what" != head ] || printf "${head[$file]}" >"$path"
    [ "$what" = empty ] || truncate -s 10000000000 "$path"
    command_of "$path"
    says=("$file")
    refuses "$what $file" "${bounded[@]}" "$bin/rgbdt" "${command[@]}"
    harmless "$what $file"
    rm "$path"
  done
done
for file in x.mcap x.lcmlog x.pcap; do
  mkfifo "$scratch/$file"
  command_of "$scratch/$file"
  says=("$file")
  refuses "a pipe as $file" "${bounded[@]}" "$bin/rgbdt" "${command[@]}"
  one_line "a pipe as $file"
  rm "$scratch/$file"
done
truncate -s 10000000000 "$scratch/huge"
mkdir "$scratch/images" "$scratch/clouds"
for i in 1 2; do
  ln -s "$good/views/000$i/rgb.png" "$scratch/images/$i.png"
  ln -s "$good/views/000$i/cloud.pcd" "$scratch/clouds/$i.pcd"
done
for option in lens metadata; do
  case $option in
    lens) # shellcheck disable=SC2054 # the board has a comma
      command=(session --images "$scratch/images" --clouds "$scratch/clouds" --lens "$scratch/huge"
        --board 8x6@0.095,0.85x0.61)
      ;;
    metadata)
      printf '\xd4\xc3\xb2\xa1' >"$scratch/x.pcap"
      command=(import "$scratch/x.pcap" --metadata "$scratch/huge")
      ;;
  esac
  says=(huge "10000000000 bytes")
  refuses "10 GB as --$option" "${bounded[@]}" "$bin/rgbdt" "${command[@]}" --out "$scratch/kept/x"
  one_line "10 GB as --$option"
done
says=(huge "10000000000 bytes")
refuses "10 GB as a calibration" "${bounded[@]}" "$bin/rgbdt" evaluate "$good" \
  --calibration "$scratch/huge" --out "$scratch/kept"

session() {  # a fresh copy of the good one, at $scratch/bad
  chmod -R u+w "$scratch/bad" 2>/dev/null || true
  rm -rf "$scratch/bad"
  cp -r "$good" "$scratch/bad"
}
bad=$scratch/bad

# An image's text may unpack to a gigabyte, and an image of few bytes be as large as is believed.
session
python3 - "$bad/views/0001/rgb.png" "$bad/views/0002/rgb.png" <<'END'
import struct, sys, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
def png(path, width, height, depth, colour, *others):
    packer = zlib.compressobj(9)
    bits = depth * {0: 1, 2: 3, 6: 4}[colour]
    rows = b"".join(packer.compress(bytes(1 + (bits * width + 7) // 8)) for _ in range(height))
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" +
                chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)) +
                b"".join(others) + chunk(b"IDAT", rows + packer.flush()) + chunk(b"IEND", b""))
packer = zlib.compressobj(9)
zeros = b"".join(packer.compress(bytes(1 << 20)) for _ in range(1000)) + packer.flush()
text = [chunk(b"zTXt", b"Comment\0\0" + zeros), chunk(b"iTXt", b"More\0\1\0\0\0" + zeros),
        chunk(b"iCCP", b"profile\0\0" + zeros)]
png(sys.argv[1], 1936, 1456, 8, 0, *text)
png(sys.argv[2], 11584, 11584, 8, 0)
END
says=("view 0002 not read" "11584x11584")
refuses "images that unpack to much" "${bounded[@]}" "$bin/rgbdt" calibrate "$bad" --out "$scratch/out"
harmless "images that unpack to much"

# Names in any script, and what they might do to a terminal, a page, a shell or a text file.
session
mkdir "$scratch/outside"
# shellcheck disable=SC2016 # it is the name
names=('вид 視野 🌡' 'צפייה' '"quoted" \ & <b>$(touch touched)' '-rf')
cd "$scratch"
i=0
for name in "${names[@]}"; do
  i=$((i + 1))
  mv "$bad/views/000$i" "$bad/views/$name"
done
for verb in calibrate evaluate fuse export intrinsics; do
  accepts "names of any script ($verb)" "${bounded[@]}" "$bin/rgbdt" "$verb" "$bad"
  harmless "names of any script ($verb)"
done
[ ! -e "$scratch/touched" ] || complain "a name was run as a command"
python3 -c 'import json, sys; json.load(open(sys.argv[1], encoding="utf-8"))' "$bad/report.json" \
  >"$scratch/output" 2>&1 || complain "report.json is no JSON"
! grep -qF "<b>\$(touch" "$bad/report.html" || complain "a name is HTML in report.html"
for name in $'two\nlines' $'\e[2J' $'\u009b2J' $'rub\x7fout' $'line\u2028two' $'\u202egnp.exe' \
  $'not \xff UTF-8'; do
  session
  mv "$bad/views/0002" "$bad/views/$name"
  for verb in calibrate evaluate fuse intrinsics; do
    says=("views" "rename")
    refuses "a name of no text ($verb)" "${bounded[@]}" "$bin/rgbdt" "$verb" "$bad" --out "$scratch/kept"
    one_line "a name of no text ($verb)"
  done
done
for name in '\\n\\033[2J' '\\302\\233' '\\342\\200\\256'; do # the last two: U+009B, U+202E
  session
  sed -i "s|file: \"rgb.png\"|file: \"rgb$name.png\"|" "$bad/views/0002/view.textproto"
  says=("0002")
  refuses "a file of no text" "${bounded[@]}" "$bin/rgbdt" calibrate "$bad" --out "$scratch/out"
  harmless "a file of no text"
done

# Names that stand in its texts.
for name in '\\033[2J' '\\342\\200\\256'; do
  session
  sed -i "0,/name: \"/s//name: \"$name/" "$bad/rig.textproto"
  for verb in calibrate evaluate fuse export intrinsics; do
    says=("rig.textproto:4" "control character")
    refuses "a rig's name of no text ($verb)" "${bounded[@]}" "$bin/rgbdt" "$verb" "$bad" --out "$scratch/kept"
    one_line "a rig's name of no text ($verb)"
  done
done

# What is written goes into the directory, whatever lies there under its name.
session
echo precious >"$scratch/outside/precious"
for name in calibration.textproto report.json report.html fused.ply fused.pcd fused.png intrinsics.textproto \
  calibration.previous.textproto launch.py; do
  ln -s "$scratch/outside/precious" "$bad/$name"
done
for name in export refined; do
  ln -s "$scratch/outside" "$bad/$name"
done
for verb in calibrate evaluate fuse export intrinsics refine; do
  "${bounded[@]}" "$bin/rgbdt" "$verb" "$bad" >"$scratch/output" 2>&1 </dev/null || true
  [ "$(cat "$scratch/outside/precious")" = precious ] || complain "$verb wrote through a link"
  [ "$(ls "$scratch/outside")" = precious ] || complain "$verb wrote outside"
done

# Very many views: told in few words, soon, in little memory and small files. What could be read is
# calibrated all the same.
patience=400  # of a busy machine
small() { # WHAT FILE_OF_IT MOST_BYTES PATH
  [ "$(stat -c %s "$4")" -lt "$3" ] || complain "$1: $2 of $(stat -c %s "$4") bytes"
}
many_views() { # VERB
  says=("100000 views not read")
  refuses "100,000 views ($1)" "${bounded[@]}" "$bin/rgbdt" "$1" "$bad" --out "$scratch/out/$1"
  [ "$(grep '^rgbdt: ' "$scratch/output" | wc -c)" -lt 2000 ] || complain "100,000 views ($1): all are told"
}
session
python3 - "$bad/views" <<'END'
import os, sys
for i in range(100000):
    os.mkdir(f"{sys.argv[1]}/{i + 10}")
END
bounded=(bash -c 'ulimit -v 1500000 -t 120; exec "$@"' bounded)
many_views calibrate
grep -q '99900 more views could not be read' "$scratch/output" ||
  complain "100,000 views: those that are not listed are not counted"
small "100,000 views" report.json 1000000 "$scratch/out/calibrate/report.json"
accepts "four views" "$bin/rgbdt" calibrate "$good" --out "$scratch/out/few"
small "100,000 views" report.html $(($(stat -c %s "$scratch/out/few/report.html") + 1000000)) \
  "$scratch/out/calibrate/report.html"
many_views intrinsics

verdict
