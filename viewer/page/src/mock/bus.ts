import type { BusFrame, MountsFrame, TargetStatusFrame, WaveFrame } from "../protocol";

const wave = (base: number, seconds: number): number => base * (1 + 0.05 * Math.sin(seconds) + 0.03 * (Math.random() - 0.5));

function process(name: string, text: string, age_s: number, counts: Record<string, number>,
  last_problem = ""): BusFrame["processes"][number] {
  const counters = Object.entries(counts).map(([key, value]) => ({ name: key, value }));
  return { process: name, ready: true, text, last_problem, age_s, counters };
}

export function busFrame(seconds: number): BusFrame {
  const channel = (name: string, rate: number, size_bytes: number, latency_ms: number | null, lost = 0) => {
    const rate_hz = wave(rate, seconds);
    return { name, count: Math.floor(rate * seconds), rate_hz, bytes_per_s: rate_hz * size_bytes, size_bytes, latency_ms, lost };
  };
  return {
    type: "bus",
    channels: [
      channel("CLOUD", 12, 1_310_000, wave(8, seconds)), channel("RGBDT_CLOUD", 12, 1_900_000, wave(15, seconds)),
      channel("RGB_IMAGE", 10, 2_818_000, wave(5, seconds), 3), channel("THERMAL_IMAGE", 9, 655_000, wave(4, seconds)),
      channel("LINE_SCAN", 40, 17_000, wave(2, seconds)), channel("STATUS", 6, 400, 1), channel("RIG", 1, 4_200, null),
    ],
    processes: [
      process("rgbdt-assembler", "sweep of 4.2 s, 1081 beams", 0.4, { sweeps: 17, lines_lost: 0 }),
      process("rgbdt-fuser", "rgb, thermal calibrated", 0.7, { points: 1_234_567 }, "thermal: image 250 ms late"),
      { ...process("rgbdt-detector", "waits for a rig", 6.1, {}, "no RIG message for 5 s"), ready: false },
    ],
    browsers: [{ address: "127.0.0.1:40112", waiting: 0, thinned: 12, share: 0.8 }],
    screen_ms: { p50: wave(60, seconds), p95: wave(110, seconds), count: 200 },
  };
}

export function mountsFrame(seconds: number): MountsFrame {
  const now = Date.now() * 1000;
  const drift = (scale: number) => Array.from({ length: 60 }, (_, i) => ({
    utime: now - (59 - i) * 2e6,
    rotation_deg: scale * Math.abs(Math.sin((seconds + i) / 20)) + 0.01,
  }));
  return {
    type: "mounts",
    cameras: [
      { camera: "rgb", state: "holds", holds: 0.9996, text: "holds, as far as 5 sweeps tell", utime: now,
        where: [0.2, 0.1, 0.1, 0, 0.2, 0.1, 0.1, 0, 0.1, 0.1, 0, 0], steps: drift(0.03) },
      { camera: "thermal", state: "moved", holds: 0.0002, utime: now,
        text: "moved by 0.42 +- 0.05 deg, mostly a turn about the camera's y (yaw), and by 3 +- 4 mm: fasten the mount, then calibrate again or run `rgbdt refine`",
        where: [0, 0.1, 0.1, 0, 0.2, 0.3, 0.3, 0, 0, 0, 0, 0], steps: drift(0.42) },
    ],
  };
}

/// Over and over: 20 s of waving, 5 s of solving, then the result.
export function waveFrame(seconds: number): WaveFrame {
  const at = seconds % 40, waved = Math.min(at, 20);
  const sigma = (second: number): number => 4 / Math.sqrt(1 + second ** 2);
  const steps = Array.from({ length: Math.floor(waved) }, (_, i) => ({
    seconds: i + 1,
    cameras: [{ camera: "rgb", sigma_ms: sigma(i) }, ...(i < 5 ? [] : [{ camera: "thermal", sigma_ms: 3 * sigma(i) }])],
  }));
  const told = (camera: string, offset: number, scale: number, from: number) => waved < from
    ? { camera, offset_ms: null, sigma_ms: null, text: "seen in 4 images; 20 are needed" }
    : { camera, offset_ms: offset, sigma_ms: scale * sigma(waved - 1), text: "" };
  const phase = at < 20 ? "recording" : at < 25 ? "solving" : "done";
  return {
    type: "wave", phase, left_s: Math.ceil(20 - waved),
    text: { recording: "wave the board towards the sensors and away, and tilt it; 120 CLOUD, 240 RGB_IMAGE", solving: "solving ...",
      done: "wrote calibration.textproto into out/sync\nnext: rgbdt-monitor out/sync" }[phase],
    cameras: [told("rgb", -12.34, 1, 1), told("thermal", 48.6, 3, 6)], steps,
  };
}

export function targetStatusFrame(seconds: number): TargetStatusFrame {
  const utime = Date.now() * 1000;
  const seen = Math.sin(seconds / 5) > 0;
  return {
    type: "target_status",
    sensors: [
      { sensor: "lidar", kind: "lidar", seen: true, text: "board 3.42 m away", utime, age_s: 0.8 },
      { sensor: "rgb", kind: "color", seen: true, text: "board found, 35 corners", utime, age_s: 0.2 },
      { sensor: "thermal", kind: "thermal", seen, text: seen ? "board found" : "no board: contrast 0.3 K", utime, age_s: 0.3 },
    ],
  };
}
