// The distribution of the errors of the test cases, and the cases that failed.
import { make_number_axis, make_plot, make_vertical, get_line_style } from '../charts/marks';
import { shorten_all } from '../charts/names';
import { make_line, type Part, type Point } from '../charts/parts';
import type { TestErrors } from '../data';
import type { Cell, Figure, TableItem, Value } from '../model';
import { format_number } from '../numbers';
import { are_positive, count_of, find_range, flatten, get_shown, is_number, name_axis } from './quantities';

const kBinsADecade = 20;
const kMostBins = 80;
const kLeastBins = 12;

export interface Histogram {
  edges: number[];
  counts: number[][]; // one list per list of values
}

// Returns bins of equal width, on a logarithmic axis if `log` is true. Every number is in one bin.
export function make_histogram(lists: (number | null)[][], log: boolean): Histogram | null {
  const range = find_range(flatten(lists));
  if (range === null) {
    return null;
  }
  const to = (value: number) => (log ? Math.log(value) / Math.LN10 : value);
  let low = to(range[0]);
  let high = to(range[1]);
  if (!(high - low > 1e-9 * Math.max(1, Math.abs(low)))) {
    const half = log ? 0.1 : Math.max(1e-9, 0.05 * Math.abs(low));
    low -= half;
    high += half;
  }
  const bins = log ? Math.min(kMostBins, Math.max(kLeastBins, Math.ceil((high - low) * kBinsADecade))) : 30;
  const width = (high - low) / bins;
  const edges: number[] = [];
  for (let i = 0; i <= bins; ++i) {
    const edge = low + i * width;
    edges.push(log ? Math.pow(10, edge) : edge);
  }
  const counts = lists.map((values) => {
    const count: number[] = edges.slice(1).map(() => 0);
    values.filter(is_number).forEach((value) => {
      count[Math.max(0, Math.min(bins - 1, Math.floor((to(value) - low) / width)))] += 1;
    });
    return count;
  });
  return { edges, counts };
}

export function make_errors_figure(test: TestErrors): Figure | null {
  const shown = get_shown(test.quantity);
  const lists = test.designs.map((design) => design.errors.map((error) => (is_number(error) ? error * shown.factor : null)));
  const log = are_positive(flatten(lists));
  const histogram = make_histogram(lists, log);
  if (histogram === null) {
    return null;
  }
  const names = shorten_all(test.designs.map((design) => design.name));
  const missing = test.designs.map((design) => design.errors.filter((error) => !is_number(error)).length);
  const labels = names.map((name, i) =>
    test.designs[i].failures.length > 0 ? `${name}, ${test.designs[i].failures.length} failed` : name,
  );
  const { edges, counts } = histogram;
  const limit = test.failure_error === null ? null : test.failure_error * shown.factor;
  // A limit far above all errors would squeeze them, so it is left out.
  const has_limit = limit !== null && limit > edges[0] && limit < edges[edges.length - 1] * (log ? 5 : 1.2);
  return {
    kind: 'figure',
    id: 'test-errors',
    title: `${shown.name.replace(/^./, (letter) => letter.toUpperCase())} of the test cases`,
    caption:
      `The number of cases with an error of each size, of the ${count_of(test.designs[0].errors.length, 'case')} of ${test.set}${test.engine === '' ? '' : `, simulated by ${test.engine}`}. The bins have equal width` +
      `${log ? ' on the logarithmic axis' : ''}. ` +
      (limit !== null
        ? has_limit
          ? `A case above the dashed line at ${format_number(limit, 3)} ${shown.unit} has failed. `
          : `A case above ${format_number(limit, 3)} ${shown.unit} would have failed; this limit is beyond the axis. `
        : '') +
      (missing.some((count) => count > 0)
        ? `Cases without a number are not in the bins: ${names
            .map((name, i) => `${name} ${missing[i]}`)
            .filter((_, i) => missing[i] > 0)
            .join(', ')}. `
        : '') +
      (test.engine === '' ? '' : `A tail to the right matters more than the mean: look at these motions in the replay.`),
    draw: (look) => {
      const series: Part[] = counts.map((count, s) => {
        const points: Point[] = [[edges[0], 0]];
        count.forEach((value, i) => points.push([edges[i], value], [edges[i + 1], value]));
        points.push([edges[edges.length - 1], 0]);
        return {
          ...make_line(look, s, labels[s], points, { width: 1.6, style: get_line_style(look, s) }),
          areaStyle: { opacity: 0.12 },
        };
      });
      if (has_limit) {
        series.push(make_vertical(look, limit as number, 'failed', look.bad));
      }
      return make_plot(
        look,
        make_number_axis(look, 'x', name_axis(shown.name, shown.unit), {
          log,
          values: has_limit ? [...edges, limit] : edges,
        }),
        make_number_axis(look, 'y', 'cases', { min: 0 }),
        series,
      );
    },
    table: () => ({
      columns: [
        { label: 'from', unit: shown.unit, numeric: true },
        { label: 'to', unit: shown.unit, numeric: true },
        ...test.designs.map((design) => ({ label: design.name, unit: 'cases', numeric: true })),
      ],
      rows: [
        ...counts[0].map((_, i): Value[] => [edges[i], edges[i + 1], ...counts.map((count) => count[i])]),
        ...(missing.some((count) => count > 0) ? [[null, null, ...missing] as Value[]] : []),
      ],
    }),
  };
}

export function make_failures_table(test: TestErrors): TableItem | null {
  const shown = get_shown(test.quantity);
  const rows: (Value | Cell)[][] = [];
  test.designs.forEach((design) => {
    design.failures.forEach((failure) => {
      const made: Cell = {
        value: `${test.set}, case ${failure.case}`,
        command: failure.command || undefined,
        note: failure.reason || undefined,
      };
      rows.push([design.name, made, is_number(failure.error) ? failure.error * shown.factor : null, failure.reason, failure.command]);
    });
  });
  if (rows.length === 0) {
    return null;
  }
  const limit =
    test.failure_error === null ? '' : ` with an error above ${format_number(test.failure_error * shown.factor, 3)} ${shown.unit} or`;
  return {
    kind: 'table',
    id: 'failures',
    title: 'Failed test cases',
    caption: `The cases${limit} without any number. Each has the command that simulates it again.`,
    table: {
      columns: [
        { label: 'design' },
        { label: 'case' },
        { label: 'error', unit: shown.unit, numeric: true },
        { label: 'reason' },
        { label: 'command' },
      ],
      rows,
    },
  };
}
