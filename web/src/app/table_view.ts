// Tables that the reader can sort by any column, in the page and in a dialog.
import { get_value, to_csv, get_heading } from '../csv';
import type { Cell, Column, DataTable, Provenance, TableItem, Value } from '../model';
import { format_number } from '../numbers';
import { make_cut_box } from './cut_box';
import { make, make_button } from './dom';
import { download } from './download';
import { make_provenance } from './provenance';
import { explain, make_text } from './term_view';
import { split_terms } from './terms';
import type { View } from './view';

// A table shows this many rows at a time, so that a table of 10 000 cells opens at once.
const kPortion = 200;
const kShortUnit = 8; // characters
const kLong = 24; // characters of a text that needs a wide column

// Compares numbers by size and texts by the alphabet. Missing values come last for both directions.
function compare(a: Value, b: Value, direction: number): number {
  if (a === null || b === null) {
    return a === b ? 0 : a === null ? 1 : -1;
  }
  if (typeof a === 'number' && typeof b === 'number') {
    return (a - b) * direction;
  }
  return String(a).localeCompare(String(b), 'en', { numeric: true }) * direction;
}

function make_cell(cell: Value | Cell, column: Column, details: HTMLElement): HTMLTableCellElement {
  const value = get_value(cell);
  const text = typeof value === 'number' ? format_number(value, column.digits ?? 4) : (value ?? '–');
  const kind = typeof value === 'number' || column.numeric ? 'number' : text.length > kLong ? 'long' : '';
  const element = make('td', { class: kind });
  const provenance: Provenance = cell !== null && typeof cell === 'object' ? cell : {};
  if (provenance.command || provenance.note) {
    element.append(
      make_button(text, () => details.replaceChildren(make_provenance(provenance, () => details.replaceChildren())), {
        class: 'link',
        title: 'Show the origin of this value',
      }),
    );
  } else if (cell !== null && typeof cell === 'object' && cell.mark !== undefined) {
    element.append(make('span', { class: 'mark ' + cell.mark }, text));
  } else {
    element.textContent = text;
  }
  if (typeof value === 'number') {
    element.title = String(value);
  }
  return element;
}

// Returns the heading with a short unit, such as "N m", that no line breaks.
function get_unbroken_heading(column: Column): string {
  const { unit = '' } = column;
  return get_heading(unit.length <= kShortUnit ? { ...column, unit: unit.replace(/ /g, '\u00a0') } : column);
}

// The order in which a table is sorted: the index of a column, and 1 for ascending or -1 for
// descending. The choice of the reader is stored here.
interface Order {
  column: number;
  direction: number;
}

// A table in its box. `set_rows` takes other rows of the same columns; the head, the order, the number
// of rows that the reader asked for and the scroll position stay.
interface TableBox {
  element: HTMLElement;
  set_rows(rows: DataTable['rows']): void;
}

function make_table(title: string, table: DataTable, details: HTMLElement, order: Order = { column: -1, direction: 1 }): TableBox {
  const body = make('tbody');
  const headings: HTMLTableCellElement[] = [];
  let rows = table.rows;
  let shown = 0;
  const more = make_button('Show more rows', () => show(shown + 5 * kPortion), { class: 'more' });

  function show(count: number): void {
    const end = Math.min(count, rows.length);
    for (; shown < end; ++shown) {
      body.append(make('tr', {}, ...rows[shown].map((cell, i) => make_cell(cell, table.columns[i], details))));
    }
    more.hidden = shown >= rows.length;
    more.textContent = `Show more rows (${rows.length - shown} left)`;
  }

  function sort(column: number, direction: number): void {
    order.column = column;
    order.direction = direction;
    headings.forEach((heading) => heading.removeAttribute('aria-sort'));
    headings[column].setAttribute('aria-sort', direction > 0 ? 'ascending' : 'descending');
    set_rows(rows);
  }

  function set_rows(next: DataTable['rows']): void {
    const { column, direction } = order;
    rows = column < 0 ? next : next.slice().sort((a, b) => compare(get_value(a[column]), get_value(b[column]), direction));
    const enough = Math.max(shown, kPortion);
    body.replaceChildren();
    shown = 0;
    show(enough);
  }

  const head = make('tr');
  table.columns.forEach((column, i) => {
    const heading = make('th', { scope: 'col', class: column.numeric ? 'number' : '' });
    const button = make_button(get_unbroken_heading(column), () => sort(i, order.column === i ? -order.direction : 1), { class: 'sort' });
    const term = split_terms(column.label).find((part) => part.term !== undefined)?.term;
    if (term === undefined) {
      button.title = 'Sort by this column';
    } else {
      explain(button, term);
    }
    heading.append(button);
    headings.push(heading);
    head.append(heading);
  });
  if (order.column >= 0) {
    sort(order.column, order.direction);
  } else {
    show(kPortion);
  }
  return { element: make_cut_box(title, [make('table', {}, make('thead', {}, head), body), more]), set_rows };
}

export function make_table_view(item: TableItem): View {
  const details = make('div', { class: 'details', role: 'status' });
  const order: Order = { column: -1, direction: 1 };
  let table = item.table;
  let body = make_table(item.title, table, details, order);
  const element = make(
    'section',
    { class: 'card full', id: 'figure-' + item.id, 'data-figure': item.id },
    make(
      'div',
      { class: 'card-head' },
      make('h3', {}, item.title),
      item.thesis ? make('span', { class: 'thesis', title: 'The corresponding table of the thesis' }, 'thesis, ' + item.thesis) : null,
      make(
        'div',
        { class: 'buttons' },
        make_button('CSV', () => download(item.id + '.csv', 'text/csv', to_csv(table)), { title: 'Download this table' }),
      ),
    ),
    body.element,
    details,
    item.caption ? make('p', { class: 'caption' }, ...make_text(item.caption)) : null,
  );
  return {
    element,
    set_look() {},
    update(next) {
      if (next.kind !== 'table' || next.table.columns.length !== table.columns.length) {
        return false;
      }
      const has_same_head = JSON.stringify(next.table.columns) === JSON.stringify(table.columns);
      table = next.table;
      if (has_same_head) {
        body.set_rows(table.rows);
      } else {
        const newer = make_table(item.title, table, details, order);
        body.element.replaceWith(newer.element);
        body = newer;
      }
      return true;
    },
    settle() {},
    dispose() {},
  };
}

// Shows the numbers of a figure, for readers who cannot or do not want to read the chart.
export function show_table(title: string, table: DataTable): void {
  const details = make('div', { class: 'details', role: 'status' });
  const dialog = make('dialog', { 'aria-label': title });
  dialog.append(
    make(
      'div',
      { class: 'card-head' },
      make('h3', {}, title),
      make_button('Close', () => dialog.close(), { class: 'close-dialog' }),
    ),
    make_table(title, table, details).element,
    details,
  );
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
