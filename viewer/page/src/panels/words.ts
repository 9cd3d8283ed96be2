// Numbers and times as these panels say them, always with their unit.
import { fixed, isDate, kZeroCelsius, utc } from "../format";

type Number = number | null | undefined; // unknown where there is none

export function number(value: Number, decimals: number): string {
  return fixed(value ?? null, decimals);
}

function withUnit(unit: string, decimals: number): (value: Number, more?: number) => string {
  return (value, more = decimals) => fixed(value ?? null, more, unit);
}

export const px = withUnit("px", 2);
export const metres = withUnit("m", 2);
export const millimetres = withUnit("mm", 2);
export const sigmas = withUnit("sigmas", 2);
export const seconds = withUnit("s", 1);

export function degrees(value: Number, decimals = 3): string {
  const text = number(value, decimals);
  return /\d/.test(text) ? `${text}°` : text;
}

export function celsius(kelvin: number): string {
  return fixed(kelvin - kZeroCelsius, 1, "°C");
}

/// [us] as the time of day, UTC; of a clock that has no date, its seconds.
export function clock(utime: number): string {
  if (!isDate(utime)) return utc(utime);
  return `${new Date(utime / 1000).toISOString().slice(11, 23)} UTC`;
}

/// "0003" as "3", where little room is.
export function short(view: string): string {
  return view.replace(/^0+(?=.)/, "");
}

/// The same without what all the views' names begin with: "pose07" as "7". A number stays whole.
export function shortNames(views: string[]): Map<string, string> {
  const [first = "", ...others] = views;
  let same = others.length === 0 ? 0 : first.length;
  for (const other of others) while (!other.startsWith(first.slice(0, same))) --same;
  const prefix = first.slice(0, same).replace(/\d+$/, "");
  return new Map(views.map((view) => [view, short(view.slice(prefix.length) || view)]));
}

export function count(many: number, what: string): string {
  return `${many} ${what}${many === 1 ? "" : "s"}`;
}
