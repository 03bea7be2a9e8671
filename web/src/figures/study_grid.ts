// Problems and optimizers at a glance: the rank of every median, and what the tests decide about
// the leader of each problem.
import type { EChartsOption } from '../charts/echarts';
import { get_readable, mix } from '../charts/fills';
import type { Look } from '../charts/look';
import { shorten, shorten_all } from '../charts/names';
import { make_chart, type Part } from '../charts/parts';
import { estimate_width } from '../charts/scales';
import type { StudyProblem } from '../data';
import type { Figure } from '../model';
import { format_number } from '../numbers';
import { find_pair, format_p } from './study_pairs';
import { convert, describe_size, describe_value, get_unit, type Scope } from './study_parts';
import { find_standing, order_by_standing, type ProblemStanding, type Standing } from './study_standing';

const kTop = 34; // pixels for the legend
const kHeadLine = 13;
const kMostHeadLines = 3; // of the name of a problem
const kFewestLetters = 4; // in a line; with fewer the problems have numbers
const kMostNamed = 4; // problems that have names in a narrow window, too
const kWidestCell = 360;
const kWidestName = 170;
const kSize = 11; // of texts, in pixels

// The symbols are paths in a square from -5 to 5, so that the legend and the cells show the same.
interface Mark {
  standing: Standing;
  words: string;
  key: string; // in the legend, which has to fit a narrow page
  points: [number, number][]; // of a polygon; empty for none
  hollow: boolean;
}

function make_star(): [number, number][] {
  const points: [number, number][] = [];
  for (let i = 0; i < 10; ++i) {
    const radius = i % 2 === 0 ? 5.6 : 2.5;
    points.push([radius * Math.sin((i * Math.PI) / 5), -radius * Math.cos((i * Math.PI) / 5)]);
  }
  return points;
}

function make_circle(radius: number): [number, number][] {
  const points: [number, number][] = [];
  for (let i = 0; i < 24; ++i) {
    points.push([radius * Math.cos((i * Math.PI) / 12), radius * Math.sin((i * Math.PI) / 12)]);
  }
  return points;
}

const kMarks: Mark[] = [
  { standing: 'best', words: 'ranks best', key: 'ranks best', points: make_star(), hollow: false },
  { standing: 'undecided', words: 'not told apart from the leader', key: 'not told apart', points: make_circle(3.8), hollow: true },
  { standing: 'worse', words: 'worse than the leader', key: 'worse', points: [[-4.4, -3], [4.4, -3], [0, 4.6]], hollow: false }, // prettier-ignore
  { standing: 'better', words: 'better than the leader', key: 'better', points: [[-4.4, 3], [4.4, 3], [0, -4.6]], hollow: false }, // prettier-ignore
  { standing: 'untested', words: 'no verdict', key: 'no verdict', points: [[-3.5, -0.9], [3.5, -0.9], [3.5, 0.9], [-3.5, 0.9]], hollow: false }, // prettier-ignore
];

function get_mark(standing: Standing): Mark {
  return kMarks.filter((mark) => mark.standing === standing)[0];
}

// Returns the mark as a path of SVG, which is an icon of the legend.
function make_icon(mark: Mark): string {
  const path = (points: [number, number][]) => 'M' + points.map(([x, y]) => x.toFixed(1) + ',' + y.toFixed(1)).join('L') + 'Z';
  return 'path://' + path(mark.points);
}

interface Grid {
  standings: ProblemStanding[]; // one per problem
  order: number[]; // the optimizers from top to bottom
}

// Returns what the verdict says about the optimizer on the problem, in words.
function describe_standing(scope: Scope, problem: StudyProblem, { lead, leader, standings }: ProblemStanding, o: number): string {
  const name = leader >= 0 ? scope.names[leader] : '';
  const pair = leader < 0 || o === leader ? undefined : find_pair(problem.pairs, leader, o);
  const a12 = pair ? (pair.a === leader ? pair.a12 : 1 - pair.a12) : NaN;
  const numbers = pair ? ' (A12 of ' + name + ' ' + a12.toFixed(2) + ', p = ' + format_p(pair.p_holm) + ' after Holm)' : '';
  switch (standings[o]) {
    case 'best':
      return lead === 'best_of_all' ? 'it ranks best and beats every other optimizer' : 'it ranks best and no optimizer beats it';
    case 'worse':
      return name + ' beats it' + numbers;
    case 'better':
      return 'it beats ' + name + ', which leads the ranking' + numbers;
    case 'undecided':
      return o === leader ? 'it leads the ranking, but its lead is not decided' : 'it cannot be told apart from ' + name + numbers;
    default:
      return 'no verdict';
  }
}

type Drawing = { value(dimension: number): number };
type Item = { dataIndex: number; coordSys: { x: number; y: number; width: number; height: number } };

function draw_mark(mark: Mark, x: number, y: number, scale: number, ink: string): Part {
  return {
    type: 'polygon',
    shape: { points: mark.points.map(([dx, dy]) => [x + scale * dx, y + scale * dy]) },
    style: mark.hollow ? { fill: 'none', stroke: ink, lineWidth: 1.5 } : { fill: ink },
  };
}

function draw_grid(look: Look, scope: Scope, grid: Grid): EChartsOption {
  const { order, standings } = grid;
  const names = order.map((o) => scope.names[o]);
  const columns = scope.problems.length;
  const labels = shorten_all(scope.problems.map((problem) => problem.label));
  const data: Part[] = [];
  scope.problems.forEach((problem, p) =>
    order.forEach((o, row) => {
      const result = problem.results[o];
      const rank = result?.median_rank ?? null;
      const note =
        scope.names[o] +
        ' on ' +
        labels[p] +
        '; median ' +
        describe_value(result?.median ?? null, get_unit(problem.quantity)) +
        (rank === null ? '' : ', rank ' + format_number(rank, 3)) +
        '; ' +
        describe_standing(scope, problem, standings[p], o);
      data.push({ value: [p, row], note });
    }),
  );
  // The best rank has the strongest colour.
  const get_fill = (rank: number | null): string =>
    rank === null ? look.background : mix(look.background, look.series[0], 1 - (rank - 1) / Math.max(1, scope.names.length - 0.4));
  const text = (x: number, y: number, words: string, fill: string, more: Part = {}): Part => ({
    type: 'text',
    style: { x, y, text: words, fill, font: kSize + 'px ' + look.font, textAlign: 'left', textVerticalAlign: 'middle', ...more },
  });
  const get_width = (box: Item['coordSys']) => Math.min(kWidestCell, box.width / columns);
  const cells: Part = {
    type: 'custom',
    name: 'cell',
    data,
    encode: { x: 0, y: 1 },
    clip: false,
    renderItem: (item: Item, api: Drawing) => {
      const box = item.coordSys;
      const [p, row] = [api.value(0), api.value(1)];
      const problem = scope.problems[p];
      const result = problem.results[order[row]];
      const [width, height] = [get_width(box), box.height / order.length];
      const [x, y] = [box.x + p * width, box.y + row * height];
      const rank = result?.median_rank ?? null;
      const fill = get_fill(rank);
      const ink = get_readable(fill);
      const mark = get_mark(standings[p].standings[order[row]]);
      const children: Part[] = [{ type: 'rect', shape: { x, y, width, height }, style: { fill, stroke: look.background, lineWidth: 1 } }];
      const number = rank === null ? '' : format_number(rank, 3);
      const value = describe_value(result?.median ?? null, get_unit(problem.quantity));
      const scale = Math.min(1, height / 14, width / 12);
      const middle = y + height / 2;
      const fits = height >= kSize;
      if (fits && width >= 70 + estimate_width(value, kSize)) {
        children.push(draw_mark(mark, x + 16, middle, scale, ink), text(x + 32, middle, number, ink), text(x + 62, middle, value, ink));
      } else if (fits && width >= 44) {
        children.push(draw_mark(mark, x + width / 2 - 10, middle, scale, ink), text(x + width / 2 + 2, middle, number, ink));
      } else {
        children.push(draw_mark(mark, x + width / 2, middle, scale, ink));
      }
      return { type: 'group', children };
    },
  };
  const name_width = Math.min(kWidestName, Math.ceil(names.reduce((most, name) => Math.max(most, estimate_width(name, kSize)), 30)));
  // The names are drawn here, because only here the width of a column is known.
  const heads: Part = {
    type: 'custom',
    data: [[0, 0]],
    silent: true,
    clip: false,
    renderItem: (item: Item) => {
      const box = item.coordSys;
      const width = get_width(box);
      const letters = Math.floor((width - 6) / (0.62 * kSize));
      const lines = count_head_lines(scope);
      const heads = labels.map((label, p) => (letters < kFewestLetters ? String(p + 1) : shorten(label, letters * lines)));
      const children = heads.map((label, p) =>
        text(box.x + (p + 0.5) * width, box.y - 5, label, look.text, {
          textAlign: 'center',
          textVerticalAlign: 'bottom',
          width: width - 6,
          overflow: needs_more_lines(label, letters, lines) ? 'breakAll' : 'break',
          lineHeight: kHeadLine,
        }),
      );
      names.forEach((name, row) =>
        children.push(
          text(box.x - 8, box.y + ((row + 0.5) * box.height) / order.length, name, look.text, {
            textAlign: 'right',
            width: name_width,
            overflow: 'truncate',
          }),
        ),
      );
      return { type: 'group', children };
    },
  };
  const shown = get_shown_marks(grid);
  const key: Part[] = shown.map((mark) => ({
    type: 'scatter',
    name: mark.key,
    data: [],
    itemStyle: mark.hollow ? { color: 'transparent', borderColor: look.text, borderWidth: 1.5 } : { color: look.text },
  }));
  const side = (direction: 'x' | 'y'): Part => ({ type: 'value', show: false, min: 0, max: direction === 'x' ? columns : order.length });
  return make_chart(look, side('x'), side('y'), [cells, heads].concat(key), {
    grid: { left: name_width + 14, right: 4, top: kTop + get_head_height(scope), bottom: 4, narrow: { head: get_head_height(scope) + 5 } },
    legend: {
      type: 'scroll',
      left: 4,
      top: 4,
      itemWidth: 11,
      itemHeight: 11,
      itemGap: 16,
      selectedMode: false,
      data: shown.map((mark) => ({ name: mark.key, icon: make_icon(mark) })),
      textStyle: { color: look.text, fontFamily: look.font, fontSize: 12 },
      pageTextStyle: { color: look.muted },
      pageIconColor: look.accent,
      pageIconInactiveColor: look.grid,
    },
  });
}

// Returns whether the label needs more lines if it only breaks between words.
function needs_more_lines(label: string, letters: number, lines: number): boolean {
  let count = 1;
  let used = 0; // letters of the last line
  for (const word of label.split(' ')) {
    if (word.length > letters) {
      return true;
    }
    const goes_on = used > 0 && used + 1 + word.length <= letters;
    count += used > 0 && !goes_on ? 1 : 0;
    used = goes_on ? used + 1 + word.length : word.length;
  }
  return count > lines;
}

function get_shown_marks({ standings, order }: Grid): Mark[] {
  return kMarks.filter((mark) => standings.some((one) => order.some((o) => one.standings[o] === mark.standing)));
}

// Returns the number of lines for the names of problems: as many as they need in the usual width of
// a page, and two if they need more than one in a narrow page.
function count_head_lines(scope: Scope): number {
  const longest = scope.problems.reduce((most, problem) => Math.max(most, estimate_width(shorten(problem.label), kSize)), 0);
  const count = (width: number) => Math.ceil(((longest + 6) * scope.problems.length) / width);
  return Math.min(kMostHeadLines, Math.max(count(900), Math.min(2, count(180))));
}

function get_head_height(scope: Scope): number {
  return 8 + kHeadLine * count_head_lines(scope);
}

// Returns the grid, or null if there is nothing to compare.
export function make_standing_grid(scope: Scope): Figure | null {
  if (scope.names.length < 2 || scope.problems.length === 0) {
    return null;
  }
  const standings = scope.problems.map((problem) => find_standing(scope.data, problem));
  const grid: Grid = { standings, order: order_by_standing(scope, standings).filter((o) => scope.shown.indexOf(o) >= 0) };
  const row_height = scope.shown.length > 16 ? 18 : 21;
  return {
    kind: 'figure',
    id: 'standing',
    title: 'Who is best where',
    caption:
      'Each cell has the rank of the median on the test set, and the median; a stronger colour is a better rank. The rows have the best optimizer first, as the verdict sees it. ' +
      "The symbols are the verdict (Wilcoxon's signed-rank test over the replicates, corrected after Holm, at a level of 5 %): they compare an optimizer with the leader of the problem, which has the best mean rank over the replicates. The leader ranks best if it beats at least one other optimizer and none beats it. " +
      'Medians may have another order, but only the tests decide. Optimizers that are not told apart need not be equal. ' +
      (scope.problems.length > kMostNamed ? 'In a narrow window the problems have numbers, in the order of the study. ' : '') +
      describe_size(scope),
    width: 'full',
    height: kTop + get_head_height(scope) + row_height * scope.shown.length + 4,
    draw: (look) => draw_grid(look, scope, grid),
    table: () => ({
      columns: [
        { label: 'problem' },
        { label: 'optimizer' },
        { label: 'rank of the median', numeric: true, digits: 3 },
        { label: 'median', numeric: true },
        { label: 'unit' },
        { label: 'standing' },
        { label: 'in words' },
      ],
      rows: scope.problems.reduce(
        (rows, problem, p) =>
          rows.concat(
            grid.order.map((o) => {
              const unit = get_unit(problem.quantity);
              const result = problem.results[o];
              return [
                problem.label,
                scope.names[o],
                result?.median_rank ?? null,
                convert(result?.median, unit),
                unit.unit,
                get_mark(grid.standings[p].standings[o]).words,
                describe_standing(scope, problem, grid.standings[p], o),
              ];
            }),
          ),
        [] as (string | number | null)[][],
      ),
    }),
  };
}
