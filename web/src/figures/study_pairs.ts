// Every two optimizers: whether the tests tell them apart, and how often one beats the other.
import type { EChartsOption } from '../charts/echarts';
import { get_readable, mix } from '../charts/fills';
import type { Look } from '../charts/look';
import { make_axis, make_chart, type Part } from '../charts/parts';
import type { StudyPair, StudyProblem } from '../data';
import type { DataTable, Figure } from '../model';
import { describe_size, end_title, get_order, get_problem, make_problem_choices, type Scope } from './study_parts';
import { estimate_width } from '../charts/scales';

// Formats p in at most five characters: "0.25", "0.044", "4e-5", "<1e-6".
export function format_p(p: number): string {
  if (p < 1e-6) {
    return '<1e-6';
  }
  return p >= 0.995 ? '1' : p >= 0.1 ? p.toFixed(2) : p >= 0.01 ? p.toFixed(3) : p.toExponential(0);
}

// Returns blue if the row is better, orange if the column is better, and the background in between.
export function get_a12_color(look: Look, a12: number): string {
  return a12 >= 0.5 ? mix(look.background, look.series[0], (a12 - 0.5) * 1.7) : mix(look.background, look.series[1], (0.5 - a12) * 1.7);
}

export function find_pair(pairs: StudyPair[], a: number, b: number): StudyPair | undefined {
  return pairs.filter((pair) => (pair.a === a && pair.b === b) || (pair.a === b && pair.b === a))[0];
}

export interface Square {
  fill: string;
  text: string;
  marked: boolean;
}

// Returns the pairs of shown optimizers.
function list_pairs(scope: Scope, problem: StudyProblem): StudyPair[] {
  return problem.pairs.filter((pair) => scope.shown.indexOf(pair.a) >= 0 && scope.shown.indexOf(pair.b) >= 0);
}

type Drawing = { value(dimension: number): number; coord(point: number[]): number[]; size(extent: number[]): number[] };
function draw_pairs(look: Look, scope: Scope, problem: StudyProblem): EChartsOption {
  const order = get_order(scope, problem);
  const names = order.map((o) => scope.names[o]);
  const place: number[] = [];
  order.forEach((o, i) => (place[o] = i));
  const squares: Square[] = [];
  const data: Part[] = [];
  list_pairs(scope, problem).forEach((pair) => {
    const first_is_a = place[pair.a] < place[pair.b];
    const [better, worse] = first_is_a ? [pair.a, pair.b] : [pair.b, pair.a];
    const a12 = first_is_a ? pair.a12 : 1 - pair.a12;
    const note =
      scope.names[better] +
      ' against ' +
      scope.names[worse] +
      '; A12 = ' +
      a12.toFixed(3) +
      ', p = ' +
      format_p(pair.p_holm) +
      ' after Holm (' +
      format_p(pair.p) +
      ' before); ' +
      (first_is_a ? pair.wins : pair.losses) +
      ' wins, ' +
      pair.ties +
      ' ties, ' +
      (first_is_a ? pair.losses : pair.wins) +
      ' losses; ' +
      (pair.significant ? 'told apart' : 'not told apart');
    data.push({ value: [place[worse], place[better]], note });
    squares.push({ fill: get_a12_color(look, a12), text: a12.toFixed(2), marked: pair.significant });
    data.push({ value: [place[better], place[worse]], note });
    squares.push({
      fill: pair.significant ? mix(look.background, look.text, 0.22) : look.background,
      text: format_p(pair.p_holm),
      marked: pair.significant,
    });
  });
  const numbers = names.map((_, i) => String(i + 1));
  return draw_squares(
    look,
    numbers,
    names.map((name, i) => `${numbers[i]}  ${name}`),
    data,
    squares,
    ['A12 = 1\nrow better', 'column better\nA12 = 0'],
  );
}

// Draws one square per item of `data`, whose values are its column and its row, and the key of the
// colours of A12. Names of columns must be short, because they stand side by side. `ends` are the
// words at the ends of the key.
export function draw_squares(
  look: Look,
  columns: string[],
  rows: string[],
  data: Part[],
  squares: Square[],
  ends: [string, string],
): EChartsOption {
  const series: Part = {
    type: 'custom',
    name: 'pair',
    data,
    encode: { x: 0, y: 1 },
    renderItem: (item: { dataIndex: number }, api: Drawing) => {
      const square = squares[item.dataIndex];
      const [x, y] = api.coord([api.value(0), api.value(1)]);
      const [width, height] = api.size([1, 1]).map(Math.abs);
      // The text is as large as it fits. Small squares have only colours and marks.
      const size = width < 28 ? 0 : Math.min(11, width / 3.1, height / 1.6);
      const children: Part[] = [
        {
          type: 'rect',
          shape: { x: x - width / 2, y: y - height / 2, width, height },
          style: { fill: square.fill, stroke: look.grid, lineWidth: 0.6 },
        },
      ];
      if (size >= 6.5) {
        children.push({
          type: 'text',
          style: {
            x,
            y: y - (square.marked ? height * 0.08 : 0),
            text: square.text,
            fill: get_readable(square.fill),
            font: (square.marked ? 'bold ' : '') + size.toFixed(1) + 'px ' + look.font,
            textAlign: 'center',
            textVerticalAlign: 'middle',
          },
        });
      }
      if (square.marked) {
        // A bar under the number. In small squares only the bar can be read.
        const long = Math.min(width * 0.5, 16);
        const below = size >= 6.5 ? y + height * 0.3 : y;
        children.push({
          type: 'rect',
          shape: { x: x - long / 2, y: below - 0.9, width: long, height: 1.8 },
          style: { fill: get_readable(square.fill) },
        });
      }
      return { type: 'group', children };
    },
  };
  const widest = rows.reduce((most, name) => Math.max(most, estimate_width(name, 11)), 0);
  const width = Math.min(150, Math.max(30, Math.ceil(6 + widest)));
  const make_side = (direction: 'x' | 'y'): Part => ({
    ...make_axis(look, direction, '', { categories: direction === 'x' ? columns : rows, inverse: direction === 'y' }),
    name: undefined,
    axisTick: { show: false },
    axisLine: { show: false },
    axisLabel: {
      color: look.text,
      fontFamily: look.font,
      fontSize: (direction === 'x' ? columns : rows).length > 20 ? 9 : 11,
      interval: direction === 'x' ? 'auto' : 0,
      width: direction === 'x' ? 110 : width,
      overflow: 'truncate',
    },
  });
  return make_chart(look, make_side('x'), make_side('y'), [series], {
    grid: { left: width + 14, right: 100, top: 14, bottom: 30 },
    // This is only the key: the squares have their own colours.
    visualMap: {
      type: 'continuous',
      seriesIndex: [],
      min: 0,
      max: 1,
      calculable: false,
      hoverLink: false,
      orient: 'vertical',
      right: 8,
      top: 'middle',
      itemHeight: 110,
      itemWidth: 12,
      text: ends,
      textStyle: { color: look.muted, fontFamily: look.font, fontSize: 10, lineHeight: 13 },
      inRange: { color: [0, 0.25, 0.5, 0.75, 1].map((a12) => get_a12_color(look, a12)) },
    },
  });
}

export function tabulate_pairs(scope: Scope, problems: StudyProblem[]): DataTable {
  const many = problems.length > 1;
  const rows = problems.reduce(
    (all, problem) =>
      all.concat(
        list_pairs(scope, problem).map((pair) =>
          (many ? [problem.label as string | number] : []).concat([
            scope.names[pair.a],
            scope.names[pair.b],
            pair.p,
            pair.p_holm,
            pair.significant ? 'yes' : 'no',
            pair.a12,
            pair.wins,
            pair.ties,
            pair.losses,
          ]),
        ),
      ),
    [] as (string | number)[][],
  );
  const columns = [
    { label: 'a, better by the pairs' },
    { label: 'b' },
    { label: 'p', numeric: true },
    { label: 'p after Holm', numeric: true },
    { label: 'told apart' },
    { label: 'A12 of a', numeric: true, digits: 3 },
    { label: 'wins of a', numeric: true, digits: 9 },
    { label: 'ties', numeric: true, digits: 9 },
    { label: 'losses', numeric: true, digits: 9 },
  ];
  return { columns: many ? [{ label: 'problem' } as (typeof columns)[0]].concat(columns) : columns, rows };
}

// Makes the figure of the problems of the scope that have tests. Returns null if none has.
export function make_pairs(all: Scope): Figure | null {
  const scope: Scope = { ...all, problems: all.problems.filter((problem) => problem.pairs.length > 0) };
  if (scope.problems.length === 0) {
    return null;
  }
  return {
    kind: 'figure',
    id: 'pairs' + scope.suffix,
    title: end_title(scope, 'Every two optimizers'),
    caption:
      "Above the diagonal is A12, the probability that a run of the row beats a run of the column (0.5: no difference; 0.56, 0.64, 0.71: a small, medium, large one). Below the diagonal is the p-value of Wilcoxon's signed-rank test over replicates, after Holm's correction for all pairs of the problem. " +
      'Values that are significant at 0.05 are bold and underlined. Rows and columns are ordered best first, and a column has the number of its row. ' +
      'A pair that is not told apart need not be equal: more replicates may show a difference. ' +
      describe_size(scope),
    height: Math.max(340, 90 + 20 * scope.shown.length),
    width: scope.shown.length > 8 ? 'full' : 'half',
    choices: make_problem_choices(scope),
    draw: (look, picked) => draw_pairs(look, scope, get_problem(scope, picked)),
    table: (picked) => tabulate_pairs(scope, [get_problem(scope, picked)]),
  };
}
