#!/usr/bin/env bash
# Boots a Debian in TREE, where package rgbdt is installed, with a rig: its processes
# run, the one that is killed runs again, what they say is in the journal, the page is served.
# Usage: boot_test.sh TREE RIG_FILE, as root
set -euo pipefail

tree=$1
install -D -m 644 "$2" "$tree/etc/rgbdt/rig.textproto"
chroot "$tree" apt-get -qq install -y --no-install-recommends systemd dbus >/dev/null 2>&1
said=$(chroot "$tree" sh -c 'cd /tmp && cp /lib/systemd/system/rgbdt-camera@.service rgbdt-camera@rgb.service &&
  systemd-analyze verify --man=no rgbdt-camera@rgb.service /lib/systemd/system/rgbdt*[a-z].service \
  /lib/systemd/system/lcm-loopback.service /lib/systemd/system/rgbdt.target' 2>&1) || true
[ -z "$said" ] || {
  echo "FAILED: systemd-analyze verify: $said"
  exit 1
}
rm -f "$tree/root/boot.log"
cat >"$tree/root/booted.sh" <<'END_OF_SCRIPT'
#!/bin/bash
# Within: by boot_test.service, once the rig's target is up.
exec >/root/boot.log 2>&1
set -x
fail() { echo "FAILED: $*"; systemctl poweroff; exit 1; }
# within SECONDS COMMAND...
within() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}
restarts_of() { systemctl show --value -p NRestarts "$1"; }
restarted_once() { systemctl is-active rgbdt-fuser && [ "$(restarts_of rgbdt-fuser)" = 1 ]; }

units=$(systemctl show --value -p Wants rgbdt.target)
sleep 5  # in which none of them may end
for unit in $units; do
  systemctl is-active "$unit" || fail "$unit is not running"
  [ "$(restarts_of "$unit")" = 0 ] || fail "$unit did not stay up"
  user=$(stat -c %u "/proc/$(systemctl show --value -p MainPID "$unit")")
  [ "$user" -ge 61184 ] || fail "$unit runs as user $user, not as one made for it"
done
systemctl kill --signal KILL rgbdt-fuser
within 5 restarted_once || fail "it was killed and not restarted once"
journalctl --no-pager -u rgbdt-fuser | grep 'status=9/KILL' || fail "the journal does not know of it"
journalctl --no-pager -u rgbdt-viewer | grep http://127.0.0.1:8080 || fail "no address in the journal"
exec 3<>/dev/tcp/127.0.0.1/8080
printf 'GET / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nConnection: close\r\n\r\n' >&3
head -n 1 <&3 | grep ' 200 ' || fail "no page"
ls -d /var/lib/rgbdt/ || fail "no place for sessions"
restarted_once || fail "it was restarted again"
systemctl stop rgbdt.target
gone() { ! systemctl is-active "$1"; }
for unit in $units; do
  within 2 gone "$unit" || fail "$unit runs on"
  [ "$(systemctl show --value -p Result "$unit")" = success ] || fail "$unit ended badly"
done
journalctl --no-pager -u 'rgbdt-*'
echo "passed"
systemctl poweroff
END_OF_SCRIPT
chmod +x "$tree/root/booted.sh"
cat >"$tree/etc/systemd/system/boot_test.service" <<'END_OF_UNIT'
[Unit]
After=rgbdt.target multi-user.target
[Service]
ExecStart=/root/booted.sh
[Install]
WantedBy=default.target
END_OF_UNIT
chroot "$tree" systemctl enable --quiet boot_test.service rgbdt.target
# Of the tree without what is mounted in it for chroot: systemd brings its own /dev and /proc.
booted=$(mktemp -d)
mount --bind "$tree" "$booted"
timeout 120 systemd-nspawn --quiet --register=no --keep-unit --private-network --machine rgbdt-boot \
  --directory "$booted" --boot >/dev/null 2>&1 </dev/null || true
umount "$booted"
rmdir "$booted"
chroot "$tree" systemctl disable --quiet boot_test.service rgbdt.target
rm "$tree/etc/systemd/system/boot_test.service"
[ -f "$tree/root/boot.log" ] || {
  echo "FAILED: it did not boot; see: systemd-nspawn --directory TREE --boot"
  exit 1
}
cat "$tree/root/boot.log"
[ "$(tail -n 1 "$tree/root/boot.log")" = "+ systemctl poweroff" ] && grep -qx passed "$tree/root/boot.log"
