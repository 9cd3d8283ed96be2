// How marks lie on a strip of distances.

/// Each label in the lowest row where it does not lie on another; shares of the strip's length.
export function rowsOf(shares: number[], gap: number): number[] {
  const lasts: number[] = [];
  const order = shares.map((share, i) => ({ share, i })).sort((a, b) => a.share - b.share);
  const rows = new Array<number>(shares.length).fill(0);
  for (const { share, i } of order) {
    const free = lasts.findIndex((last) => share - last >= gap);
    const row = free < 0 ? lasts.length : free;
    lasts[row] = share;
    rows[i] = row;
  }
  return rows;
}

/// A round length not less than the greatest, and into how many round parts it is divided [m].
export function stripOf(greatest: number): { length: number; parts: number } {
  const length = [2, 4, 5, 8, 10, 20, 40, 50].find((each) => each >= greatest) ?? Math.ceil(greatest / 100) * 100;
  return { length, parts: [5, 10, 50].includes(length) ? 5 : 4 };
}
