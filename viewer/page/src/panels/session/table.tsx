import type { ComponentChildren } from "preact";

interface Props {
  title: string;
  note?: string;
  head: string[]; // the first column names the row
  rows: ComponentChildren[][];
  testid?: string;
}

/// Empty where there are no rows. Numbers stand to the right.
export function Table({ title, note, head, rows, testid }: Props) {
  if (rows.length === 0) return null;
  return (
    <section class="report-table" data-testid={testid}>
      <h4>{title}</h4>
      {note && <p class="muted">{note}</p>}
      <div class="scroll-x">
        <table aria-label={title}>
          <thead><tr>{head.map((name) => <th key={name} scope="col">{name}</th>)}</tr></thead>
          <tbody>{rows.map((row, i) => (
            <tr key={i}>{row.map((cell, j) => (j === 0 ? <th key={j} scope="row">{cell}</th> : <td key={j}>{cell}</td>))}</tr>
          ))}</tbody>
        </table>
      </div>
    </section>
  );
}
