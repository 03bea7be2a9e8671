// Writes and reads tables as CSV (RFC 4180). Text that a spreadsheet would take for a formula gets an
// apostrophe in front, because names may contain anything.
import type { Cell, Column, DataTable, Value } from './model';

export function get_value(cell: Value | Cell): Value {
  return cell !== null && typeof cell === 'object' ? cell.value : cell;
}

function quote(text: string): string {
  const harmless = /^[=+\-@\t\r]/.test(text) ? "'" + text : text;
  return /[",\r\n]/.test(harmless) ? '"' + harmless.replace(/"/g, '""') + '"' : harmless;
}

export function get_heading(column: Column): string {
  return column.unit ? column.label + ' (' + column.unit + ')' : column.label;
}

export function to_csv(table: DataTable): string {
  const lines = [table.columns.map((column) => quote(get_heading(column))).join(',')];
  table.rows.forEach((row) => {
    lines.push(
      row
        .map((cell) => {
          const value = get_value(cell);
          return value === null ? '' : typeof value === 'number' ? String(value) : quote(value);
        })
        .join(','),
    );
  });
  return lines.join('\r\n') + '\r\n';
}

// Returns the lines of a CSV text as cells. Empty lines are left out.
export function parse_csv(text: string): string[][] {
  const rows: string[][] = [];
  let row: string[] = [];
  let cell = '';
  let quoted = false;
  const close_row = () => {
    row.push(cell);
    cell = '';
    if (row.length > 1 || row[0] !== '') {
      rows.push(row);
    }
    row = [];
  };
  for (let i = 0; i < text.length; ++i) {
    const letter = text.charAt(i);
    if (quoted) {
      if (letter !== '"') {
        cell += letter;
      } else if (text.charAt(i + 1) === '"') {
        cell += letter;
        ++i;
      } else {
        quoted = false;
      }
    } else if (letter === '"') {
      quoted = true;
    } else if (letter === ',') {
      row.push(cell);
      cell = '';
    } else if (letter === '\n') {
      close_row();
    } else if (letter !== '\r') {
      cell += letter;
    }
  }
  close_row();
  return rows;
}
