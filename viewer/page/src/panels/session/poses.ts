// Poses of a report as 4x4 matrices, row by row.

export interface RigidMotion { quaternion_wxyz?: number[]; translation_m?: number[] }

/// null where the message is incomplete.
export function matrixOf(motion: RigidMotion | undefined): number[] | null {
  const q = motion?.quaternion_wxyz, t = motion?.translation_m;
  if (q?.length !== 4 || t?.length !== 3) return null;
  const norm = Math.hypot(...q);
  const [w, x, y, z] = q.map((value) => value / norm) as [number, number, number, number];
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), t[0]!,
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), t[1]!,
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), t[2]!,
    0, 0, 0, 1,
  ];
}

/// Of a rigid motion.
export function inverse(m: number[]): number[] {
  const at = (row: number, column: number): number => m[4 * row + column]!;
  const out: number[] = [];
  for (let row = 0; row < 3; ++row) {
    const turned = [at(0, row), at(1, row), at(2, row)];
    out.push(...turned, -(turned[0]! * at(0, 3) + turned[1]! * at(1, 3) + turned[2]! * at(2, 3)));
  }
  return [...out, 0, 0, 0, 1];
}

export function rowsOf(m: number[]): number[][] {
  return [0, 4, 8, 12].map((start) => m.slice(start, start + 4));
}

/// As JSON, and so as Python and many others read it.
export function textOf(m: number[]): string {
  return `[${rowsOf(m).map((row) => `[${row.join(", ")}]`).join(",\n ")}]`;
}
