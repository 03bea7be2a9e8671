// The values of every run, with one box per optimizer. All runs are shown; values that do not exist
// have their own place.
import type { EChartsOption } from '../charts/echarts';
import type { Look } from '../charts/look';
import type { Part } from '../charts/parts';
import { estimate_width, make_grid_lines, make_name_axis, make_scale, make_scaled_axis, place_on } from '../charts/scales';
import type { StudyCell, StudyProblem } from '../data';
import type { Cell, Figure, Picked, Value } from '../model';
import {
  convert,
  describe_size,
  describe_value,
  end_title,
  get_order,
  get_problem,
  get_style,
  get_unit,
  make_problem_choices,
  make_ranked_chart,
  name_axis,
  type Scope,
  type Unit,
} from './study_parts';

const kMostNames = 260; // pixels; names of methods are long and differ at their ends

export function describe_cell(scope: Scope, problem: StudyProblem, optimizer: number, cell: StudyCell, unit: Unit): string {
  const failed = cell.failures > 0 ? '; ' + cell.failures + (cell.failures === 1 ? ' test case' : ' test cases') + ' failed' : '';
  const failure = cell.failure === '' ? '' : '; the optimizer failed';
  return (
    scope.names[optimizer] +
    ', replicate ' +
    cell.replicate +
    '; ' +
    describe_value(cell.value, unit, problem.quantity) +
    '; ' +
    cell.cases +
    ' cases, ' +
    cell.evaluations +
    ' evaluations' +
    failed +
    failure
  );
}

// Returns a place between -0.5 and 0.5. The places of consecutive numbers are far apart.
function spread_out(replicate: number): number {
  const golden = replicate * 0.6180339887498949;
  return golden - Math.floor(golden) - 0.5;
}

type Drawing = {
  value(dimension: number): number;
  coord(point: number[]): number[];
  size(extent: number[], point: number[]): number[];
};

// Makes boxes with medians and whiskers from rows [row, min, q1, median, q3, max], which are
// already places on the axis.
function make_boxes(look: Look, data: Part[], colors: string[]): Part {
  return {
    type: 'custom',
    name: 'quartiles',
    data,
    encode: { x: [1, 2, 3, 4, 5], y: 0 },
    z: 2,
    renderItem: (item: { dataIndex: number }, api: Drawing) => {
      const row = api.value(0);
      const at = [1, 2, 3, 4, 5].map((k) => api.coord([api.value(k), row])[0]);
      const middle = api.coord([api.value(3), row])[1];
      const half = Math.min(11, Math.abs(api.size([0, 1], [0, 0])[1]) * 0.34);
      const color = colors[item.dataIndex];
      const line = (x1: number, y1: number, x2: number, y2: number, width = 1.2) => ({
        type: 'line',
        shape: { x1, y1, x2, y2 },
        style: { stroke: color, lineWidth: width },
      });
      return {
        type: 'group',
        children: [
          line(at[0], middle, at[1], middle),
          line(at[3], middle, at[4], middle),
          line(at[0], middle - half / 2, at[0], middle + half / 2),
          line(at[4], middle - half / 2, at[4], middle + half / 2),
          {
            type: 'rect',
            shape: { x: at[1], y: middle - half, width: Math.max(0, at[3] - at[1]), height: 2 * half },
            style: { fill: look.background, stroke: color, lineWidth: 1.2 },
          },
          {
            type: 'rect',
            shape: { x: at[1], y: middle - half, width: Math.max(0, at[3] - at[1]), height: 2 * half },
            style: { fill: color, opacity: 0.15 },
          },
          line(at[2], middle - half, at[2], middle + half, 2.6),
        ],
      };
    },
    clip: true,
  };
}

function draw_values(look: Look, scope: Scope, problem: StudyProblem): EChartsOption {
  const unit = get_unit(problem.quantity);
  const order = get_order(scope, problem);
  const results = order.map((o) => problem.results[o]);
  const values = results.reduce((all, one) => all.concat(one.cells.map((cell) => convert(cell.value, unit))), [] as (number | null)[]);
  const with_strip = values.some((value) => value === null) || results.some((one) => one.cells.length > 0 && one.max === null);
  const x = make_scale(values, true, with_strip);
  const boxes: Part[] = [];
  const colors: string[] = [];
  const points: Part[] = [];
  results.forEach((result, row) => {
    const color = get_style(look, scope, order[row]).color;
    if (result.cells.length > 0 || result.median !== null) {
      const five = [result.min, result.q1, result.median, result.q3, result.max].map((value) => place_on(x, convert(value, unit)));
      const note =
        scope.names[order[row]] +
        '; median ' +
        describe_value(result.median, unit) +
        '; quartiles ' +
        describe_value(result.q1, unit) +
        ' to ' +
        describe_value(result.q3, unit) +
        '; ' +
        result.infinite +
        ' without value';
      boxes.push({ value: [row].concat(five), note });
      colors.push(color);
    }
    result.cells.forEach((cell) => {
      const value = convert(cell.value, unit);
      const share = 0.5 + 0.5 * spread_out(cell.replicate * 7 + 3);
      points.push({
        value: [place_on(x, value, share), row + 0.56 * spread_out(cell.replicate)],
        note: describe_cell(scope, problem, order[row], cell, unit),
        command: cell.command,
        symbol: value === null ? 'diamond' : 'circle',
        itemStyle: { color: value === null ? look.bad : color, opacity: 0.85, borderColor: look.background, borderWidth: 0.6 },
      });
    });
  });
  const names = order.map((o) => scope.names[o]);
  const width = Math.min(kMostNames, Math.max(30, Math.ceil(names.reduce((most, name) => Math.max(most, estimate_width(name, 11)), 0))));
  const quantity = name_axis(problem.quantity.name, unit.unit);
  return make_ranked_chart(
    look,
    make_scaled_axis(look, 'x', quantity, x, 'no value'),
    make_name_axis(look, names, width),
    [
      make_grid_lines(look, x, null),
      make_boxes(look, boxes, colors),
      { type: 'scatter', name: 'run', data: points, symbolSize: order.length > 20 ? 4 : 6, z: 3 },
    ],
    [],
    [],
    { grid: { left: width + 24, right: 20, top: 10, bottom: 46 } },
  );
}

export function make_values(scope: Scope): Figure {
  const table = (picked: Picked) => {
    const problem = get_problem(scope, picked);
    const unit = get_unit(problem.quantity);
    const rows: (Value | Cell)[][] = [];
    get_order(scope, problem).forEach((o) => {
      problem.results[o].cells.forEach((cell) => {
        const value = convert(cell.value, unit);
        const shown: Cell = { value, command: cell.command, note: value === null ? 'no value' : undefined };
        rows.push([scope.names[o], cell.replicate, shown, cell.failures]);
      });
    });
    return {
      columns: [
        { label: 'optimizer' },
        { label: 'replicate', numeric: true },
        { label: problem.quantity.name, unit: unit.unit, numeric: true },
        { label: 'failed test cases', numeric: true, digits: 9 },
      ],
      rows,
    };
  };
  return {
    kind: 'figure',
    id: 'values' + scope.suffix,
    title: end_title(scope, 'Value of every run'),
    caption:
      'Each point is a run. Its place is the value of the winner on the test set, which was not used for training. The boxes are quartiles with the median, and the whiskers reach to the best and the worst run. The best mean rank is at the top. ' +
      'A run whose winner fails on a test case or violates a constraint has no value. It counts as the worst and is shown beyond the axis. ' +
      (scope.problems.some((problem) => problem.has_front)
        ? 'With several objectives the value is the share of the hypervolume that the front of a run misses. It depends on the optimizers that take part. '
        : '') +
      'Optimizers with overlapping boxes need not be equal: runs are paired by replicate, and the tests use these pairs. ' +
      describe_size(scope),
    width: scope.shown.length > 16 ? 'full' : 'half',
    height: Math.max(320, 70 + 24 * scope.shown.length),
    choices: make_problem_choices(scope),
    draw: (look, picked) => draw_values(look, scope, get_problem(scope, picked)),
    table,
  };
}
