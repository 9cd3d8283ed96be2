// Numbers for a person, with their units.

export const kZeroCelsius = 273.15; // [K]
const kNothing = "–";
const kThin = "\u202f"; // a narrow space that does not break

export function fixed(value: number | null, digits: number, unit = ""): string {
  if (value === null || !Number.isFinite(value)) return kNothing;
  return value.toFixed(digits).replace("-", "−") + (unit && kThin + unit);
}

export const metres = (value: number | null): string => fixed(value, 3, "m");
export const celsius = (kelvin: number | null): string => fixed(kelvin === null ? null : kelvin - kZeroCelsius, 2, "°C");

export const grouped = (value: number): string => Math.round(value).toString().replace(/\B(?=(\d{3})+$)/g, kThin);

/// In B, kB, MB: three figures.
export function bytes(value: number): string {
  if (value < 1000) return `${Math.round(value)}${kThin}B`;
  const [scaled, unit] = value < 1e6 ? [value / 1e3, "kB"] : [value / 1e6, "MB"];
  return fixed(scaled, scaled < 10 ? 2 : scaled < 100 ? 1 : 0, unit);
}

const kFirstDate = 946_684_800e6; // 2000-01-01 [us]; before that a clock counts from when it was switched on

/// Whether a time is one of the calendar, [us].
export const isDate = (utime: number): boolean => utime >= kFirstDate;

/// "2026-11-22 10:20:30.123456 UTC"; of a clock that has no date, its seconds.
export function utc(utime: number): string {
  if (!isDate(utime)) return utime > 0 ? fixed(utime / 1e6, 6, "s") : kNothing;
  const whole = new Date(Math.floor(utime / 1e6) * 1000);
  if (Number.isNaN(whole.getTime())) return kNothing;
  const micros = String(Math.floor(utime % 1e6)).padStart(6, "0");
  return `${whole.toISOString().slice(0, 19).replace("T", " ")}.${micros}${kThin}UTC`;
}
