// A logarithmic axis with marks at round numbers.

const kCoarse = [1, 2, 5], kFine = [1, 1.5, 2, 3, 4, 5, 6, 8];
const kFewMarks = 4;

function marksAt(steps: number[], least: number, most: number): number[] {
  const marks: number[] = [];
  for (let power = Math.floor(Math.log10(least)) - 1; power <= Math.ceil(Math.log10(most)) + 1; ++power) {
    for (const step of steps) marks.push(Number((step * 10 ** power).toPrecision(2)));
  }
  // Below the least and above the most, also where they are one and the same.
  const first = marks.filter((mark) => mark < least).length - 1;
  const last = marks.findIndex((mark) => mark > most);
  return marks.slice(first, last + 1);
}

/// Marks that enclose all values above zero, in order; empty where there are none.
export function logMarks(values: number[]): number[] {
  const above = values.filter((value) => value > 0 && Number.isFinite(value));
  if (above.length === 0) return [];
  const least = Math.min(...above), most = Math.max(...above);
  const coarse = marksAt(kCoarse, least, most);
  return coarse.length < kFewMarks ? marksAt(kFine, least, most) : coarse;
}
