// Rates of the last minutes, by channel.
import { effect } from "@preact/signals";
import { bus } from "../../store";

const kKept = 120; // frames, of a second each
export const rates = new Map<string, number[]>();

effect(() => {
  for (const { name, rate_hz } of bus.value?.channels ?? [])
    rates.set(name, [...(rates.get(name) ?? []), rate_hz].slice(-kKept));
});
