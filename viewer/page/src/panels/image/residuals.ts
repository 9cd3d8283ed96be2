// How far the cloud's board edge lies from the outline in the image, as classes of a legend.

export const kResidualClasses = [
  { name: "good", words: "≤ 1 px", colour: "#3df07a", mark: "dot" },
  { name: "near", words: "1 to 4 px", colour: "#ffd93b", mark: "square" },
  { name: "far", words: "> 4 px", colour: "#ff5a4d", mark: "cross" },
  { name: "unknown", words: "no outline", colour: "#c8c8c8", mark: "ring" },
] as const;
export type ResidualClass = (typeof kResidualClasses)[number];

export function classOf(residual: number): number {
  if (Number.isNaN(residual)) return 3;
  const size = Math.abs(residual);
  return size <= 1 ? 0 : size <= 4 ? 1 : 2;
}

export interface ResidualSummary { counts: number[]; rms: number | null } // rms [px]

/// Of records x y r [px].
export function summaryOf(edge: Float32Array): ResidualSummary {
  const counts = [0, 0, 0, 0];
  let sum = 0, known = 0;
  for (let i = 2; i < edge.length; i += 3) {
    const residual = edge[i]!;
    counts[classOf(residual)]!++;
    if (Number.isNaN(residual)) continue;
    sum += residual * residual;
    ++known;
  }
  return { counts, rms: known > 0 ? Math.sqrt(sum / known) : null };
}
