import type { Cell, Table } from "../../protocol";
import { gradeClass, kGradeIcon } from "./verdict";

function Marked({ cell: { text, mark } }: { cell: Cell }) {
  return mark === "none" ? <>{text}</> : <span class={gradeClass(mark)}>{kGradeIcon[mark]} {text}</span>;
}

/// Without its title where the section has one.
export function TableView({ table, titled = true }: { table: Table; titled?: boolean }) {
  const { title, notes, head, rows } = table;
  return (
    <section class="report-table">
      {titled && <h4>{title}</h4>}
      {notes.map((note) => <p key={note} class="muted">{note}</p>)}
      {rows.length > 0 && (
        <div class="scroll-x">
          <table aria-label={title}>
            <thead><tr>{head.map((name, j) => <th key={j} scope="col">{name}</th>)}</tr></thead>
            <tbody>{rows.map((row, i) => (
              <tr key={i}>{row.map((cell, j) => (j === 0
                ? <th key={j} scope="row">{cell.text}</th> : <td key={j}><Marked cell={cell} /></td>))}</tr>
            ))}</tbody>
          </table>
        </div>
      )}
    </section>
  );
}
