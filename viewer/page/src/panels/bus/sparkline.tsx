// A rate's course, from 0 to its most, without axes: the figure stands beside it.
interface Props { values: number[]; label: string }

const kWidth = 64;
const kHeight = 24;

export function Sparkline({ values, label }: Props) {
  const most = Math.max(...values, 1e-9);
  const step = kWidth / Math.max(1, values.length - 1);
  const points = values.map((value, i) => `${(i * step).toFixed(1)},${(kHeight - 2 - (value / most) * (kHeight - 4)).toFixed(1)}`);
  return (
    <svg class="sparkline" width={kWidth} height={kHeight} viewBox={`0 0 ${kWidth} ${kHeight}`} role="img" aria-label={label}>
      <polyline points={points.join(" ")} fill="none" stroke="currentColor" stroke-width="2" />
    </svg>
  );
}
