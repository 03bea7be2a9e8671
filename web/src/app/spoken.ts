// The sentences that a screen reader says in place of a chart. They are made from the table of the figure and name
// what the eye sees first: the leader of the curves and its distance from the others, or the range of each curve.
import { join_names, shorten } from '../charts/names';
import { get_value } from '../csv';
import type { Column, DataTable } from '../model';
import { format_number } from '../numbers';

const kMostNames = 3; // a longer sentence is forgotten before it ends

type Row = DataTable['rows'][number];

interface Curve {
  name: string;
  x: number[];
  y: number[];
}

function say(value: number, column: Column): string {
  const unit = column.unit === '1' ? '' : (column.unit ?? '');
  return format_number(value, 3) + (unit === '' ? '' : ' ' + unit);
}

// Returns "140 cases" or "generation 40".
function say_place(value: number, column: Column): string {
  const name = column.label.replace(/,.*/, '');
  const is_count = !column.unit && name.endsWith('s');
  return is_count ? say(value, column) + ' ' + (value === 1 ? name.slice(0, -1) : name) : name + ' ' + say(value, column);
}

function say_range(values: number[], column: Column): string {
  const lowest = values.reduce((least, value) => Math.min(least, value));
  const highest = values.reduce((most, value) => Math.max(most, value));
  return lowest === highest ? `stays at ${say(lowest, column)}` : `ranges from ${say(lowest, column)} to ${say(highest, column)}`;
}

// Returns the first parts as a list that ends with the number of the others.
function join_some(parts: string[]): string {
  const rest = parts.length - kMostNames;
  return rest > 1 ? `${parts.slice(0, kMostNames).join(', ')} and ${rest} others` : join_names(parts);
}

function find_median(values: number[]): number {
  const sorted = values.slice().sort((a, b) => a - b);
  return (sorted[Math.floor((sorted.length - 1) / 2)] + sorted[Math.ceil((sorted.length - 1) / 2)]) / 2;
}

// Returns the curve in the columns x and y of the rows, without the points that lack one of them.
function read_curve(name: string, rows: Row[], x: number, y: number): Curve {
  const points = rows
    .map((row) => [get_value(row[x]), get_value(row[y])])
    .filter((point) => point.every((one) => typeof one === 'number' && isFinite(one)));
  return { name, x: points.map((point) => point[0] as number), y: points.map((point) => point[1] as number) };
}

function group_rows(rows: Row[]): Map<string, Row[]> {
  const groups = new Map<string, Row[]>();
  for (const row of rows) {
    const name = String(get_value(row[0]));
    const group = groups.get(name);
    if (group === undefined) {
      groups.set(name, [row]);
    } else {
      group.push(row);
    }
  }
  return groups;
}

// Describes the last values of curves that optimizers have over a budget or a tolerance.
function describe_ends(curves: Curve[], x: Column, y: Column): string {
  const is_share = y.label.startsWith('share');
  const sign = is_share ? -1 : 1;
  const end = (curve: Curve): number => curve.y[curve.y.length - 1];
  const order = curves.slice().sort((a, b) => sign * (end(a) - end(b)));
  const best = order.filter((curve) => end(curve) === end(order[0]));
  const others = order.slice(best.length);
  const has = best.length > 1 ? 'have' : 'has';
  const last = say_place(order[0].x[order[0].x.length - 1], x);
  const leaders = join_some(best.map((curve) => curve.name));
  if (others.length === 0) {
    return `${leaders} ${has} ${say(end(order[0]), y)} at ${last} (${y.label}).`;
  }
  // Returns the value of a curve of steps.
  const at = (curve: Curve, place: number): number => curve.y[curve.x.filter((one) => one <= place).length - 1] ?? sign * Infinity;
  const behind = order[0].x.filter((place) => others.some((other) => sign * (at(other, place) - at(order[0], place)) < 0));
  const lead = order[0].x.find((place) => behind.length === 0 || place > behind[behind.length - 1]);
  const since = best.length > 1 || lead === undefined ? '' : behind.length === 0 ? ' throughout' : ` from ${say_place(lead, x)} on`;
  const rest = join_some(others.map((curve) => `${say(end(curve), y)} of ${curve.name}`));
  return `${leaders} ${has} the ${is_share ? 'highest' : 'lowest'} ${y.label}${since}: ${say(end(order[0]), y)} at ${last}, against ${rest}.`;
}

// Describes values that belong together without an order, such as those of replicates.
function describe_spread(curves: Curve[], y: Column): string {
  const order = curves.map((curve) => ({ ...curve, median: find_median(curve.y) })).sort((a, b) => a.median - b.median);
  const [best, ...others] = order;
  const rest = others.length === 0 ? '' : ', against ' + join_some(others.map((one) => `${say(one.median, y)} of ${one.name}`));
  return `${best.name} has the lowest median of ${y.label}: ${say(best.median, y)}${rest}. That of ${best.name} ${say_range(best.y, y)}.`;
}

function describe_ranges(curves: Curve[], columns: Column[]): string {
  return join_some(curves.map((curve, i) => `${curve.name} ${say_range(curve.y, columns[i])}`)) + '.';
}

// Describes columns with one value per name: which name has the lowest one and which the highest.
function describe_names(table: DataTable, numeric: number[]): string {
  const sentences: string[] = [];
  for (const y of numeric) {
    const value = (row: Row): number => get_value(row[y]) as number;
    const rows = table.rows.filter((row) => typeof get_value(row[y]) === 'number');
    if (rows.length > 0 && sentences.length < 2) {
      const tell = (row: Row): string => `${say(value(row), table.columns[y])} of ${shorten(String(get_value(row[0])))}`;
      const lowest = rows.reduce((best, row) => (value(row) < value(best) ? row : best));
      const highest = rows.reduce((best, row) => (value(row) > value(best) ? row : best));
      sentences.push(`The lowest ${table.columns[y].label} is ${tell(lowest)}${rows.length > 1 ? ', the highest ' + tell(highest) : ''}.`);
    }
  }
  return sentences.join(' ');
}

// Describes bins with the number of test cases of each design.
function describe_bins(table: DataTable): string {
  const parts = table.columns.slice(2).map((column, k) => {
    const counts = table.rows.map((row) => Number(get_value(row[k + 2])));
    const half = counts.reduce((sum, count) => sum + count, 0) / 2;
    let sum = 0;
    const bin = counts.findIndex((count) => (sum += count) >= half);
    return `${say(Number(get_value(table.rows[bin][1])), table.columns[1])} for ${column.label}`;
  });
  return `Half of the values are at most ${join_some(parts)}.`;
}

function describe_pairs(table: DataTable, apart: number): string {
  const pairs = table.rows
    .filter((row) => get_value(row[apart]) === 'yes')
    .map((row) => `${get_value(row[apart - 4])} and ${get_value(row[apart - 3])}`);
  const names = pairs.length === 0 ? '' : ': ' + join_some(pairs);
  return `${pairs.length} of ${table.rows.length} pairs of optimizers are told apart${names}.`;
}

function describe_front(table: DataTable): string {
  const rows = table.rows.filter((row) => get_value(row[0]) !== 'no');
  const ranges = [1, 2].map((k) => `${table.columns[k].label} ${say_range(read_curve('', rows, k, k).y, table.columns[k])}`);
  return `${rows.length} of ${table.rows.length} designs are on the front, where ${ranges.join(' and ')}.`;
}

// Describes a table whose first columns are numbers and whose other columns are the curves.
function describe_columns(table: DataTable, numeric: number[]): string {
  const { columns, rows } = table;
  const is_numbered = columns[0].label === 'point';
  const x = is_numbered && columns[1].label.startsWith('distance') ? 1 : 0;
  const listed = [', mean', ', best'].map((end) => numeric.filter((k) => columns[k].label.endsWith(end))).find((some) => some.length > 0);
  const is_side = /^(cases|average|worst|evaluations without number|.*, target)$/;
  const shown = (listed ?? numeric.filter((k) => k > x && !is_side.test(columns[k].label)))
    .map((k) => ({ column: columns[k], curve: read_curve(columns[k].label.replace(/, (mean|best)$/, ''), rows, x, k) }))
    .filter(({ curve }) => curve.y.length > 0);
  const curves = shown.map(({ curve }) => curve);
  const of = shown.map(({ column }) => column);
  if (is_numbered || columns[0].label.startsWith('time')) {
    return describe_ranges(curves, of);
  }
  const parts = curves.map((curve, i) => {
    const last = curve.x.length - 1;
    const begin = `${curve.name} is ${say(curve.y[0], of[i])} at ${say_place(curve.x[0], columns[x])}`;
    return last === 0 ? begin : `${begin} and ${say(curve.y[last], of[i])} at ${say_place(curve.x[last], columns[x])}`;
  });
  return parts.slice(0, kMostNames).join('; ') + (parts.length > kMostNames ? `; ${parts.length - kMostNames} more` : '') + '.';
}

// Returns one or two sentences about what a chart of the numbers of `table` shows.
export function describe_table(table: DataTable): string {
  const { columns, rows } = table;
  const labels = columns.map((column) => column.label);
  const numeric = columns.map((_, k) => k).filter((k) => columns[k].numeric);
  if (rows.length === 0 || numeric.length === 0) {
    return 'The figure has no values to show yet.';
  }
  if (labels[0] === 'from') {
    return describe_bins(table);
  }
  if (labels[0] === 'on the front') {
    return describe_front(table);
  }
  if (labels.includes('told apart')) {
    return describe_pairs(table, labels.indexOf('told apart'));
  }
  if (columns[0].numeric) {
    return describe_columns(table, numeric);
  }
  const groups = group_rows(rows);
  const is_text_pair = columns.length > 1 && !columns[1].numeric;
  if (labels[0] === 'problem' && is_text_pair) {
    const firsts = Array.from(groups, ([problem, some]) => {
      const best = some
        .slice()
        .sort((a, b) => Number(get_value(a[numeric[0]]) ?? Infinity) - Number(get_value(b[numeric[0]]) ?? Infinity))[0];
      return `${get_value(best[1])} on ${problem}`;
    });
    return `The lowest ${labels[numeric[0]]}: ${join_some(firsts)}.`;
  }
  if (is_text_pair || groups.size === rows.length || numeric.length < 2) {
    return describe_names(
      table,
      numeric.filter((k) => labels[k] !== 'replicate'),
    );
  }
  const x = numeric[labels[numeric[0]] === 'distance class' ? 1 : 0];
  const y = numeric[numeric.indexOf(x) + 1];
  const curves = Array.from(groups, ([name, some]) => read_curve(shorten(name), some, x, y)).filter((curve) => curve.y.length > 0);
  if (curves.length === 0) {
    return 'The figure has no values to show yet.';
  }
  if (labels[x].startsWith('time')) {
    return `The ${labels[y]} ${describe_ranges(
      curves.map((curve) => ({ ...curve, name: 'of ' + curve.name })),
      curves.map(() => columns[y]),
    )}`;
  }
  return labels[x] === 'replicate' ? describe_spread(curves, columns[y]) : describe_ends(curves, columns[x], columns[y]);
}
