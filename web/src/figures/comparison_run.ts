// The page that compares two runs: which winner is better on the test set, whether they may be
// compared, and everything that both have side by side.
import { get_series_style } from '../charts/look';
import { make_curve_plot, make_number_axis, make_plot } from '../charts/marks';
import { join_names, shorten } from '../charts/names';
import { make_line, type Part, type Point } from '../charts/parts';
import type { ComparedRuns, ComparisonData, Quantity, RunData, TestErrors, VariableHistory } from '../data';
import type { Cell, Figure, Item, SummaryItem, Tab, TableItem, TextItem, Value } from '../model';
import { format_number } from '../numbers';
import { describe_change, describe_obstacles, find_obstacles, make_differences_table, make_equal_table } from './comparison_parts';
import { make_response_figure } from './distance_response';
import { make_health_item, make_tiles_item } from './health';
import { make_joint_figures } from './joints';
import { make_momentary_figure } from './momentary';
import { are_positive, count_of, flatten, get_shown, is_number, name_axis, times } from './quantities';
import { make_requirement_table } from './requirement_table';
import { keep_filled } from './run_page';
import { format_p } from './study_pairs';
import { make_errors_figure, make_failures_table } from './test_errors';
import { get_log_sign } from './variables';

const kSides = ['A', 'B'];
const kFewestPairs = 6; // as in src/study/statistics/significance.hpp

function are_same(a: Quantity | null, b: Quantity | null): boolean {
  return a !== null && b !== null && a.name === b.name && a.unit === b.unit;
}

// ---------------------------------------------------------------- the headline

// Returns why the results of the runs cannot be compared; "" if they can.
function find_refusal(data: ComparisonData, runs: ComparedRuns): string {
  const obstacles = find_obstacles(data.settings);
  if (obstacles.indexOf('the problem') >= 0) {
    return describe_obstacles(obstacles);
  }
  const [a, b] = [runs.a.headline.quantity, runs.b.headline.quantity];
  return a !== null && b !== null && !are_same(a, b) ? 'they minimise different quantities' : '';
}

function describe_result(runs: ComparedRuns): string {
  const [a, b] = [runs.a.headline, runs.b.headline];
  const without = kSides.filter((_, i) => ![a, b][i] || !is_number([a, b][i].value));
  if (without.length > 0) {
    const yet = without.some((side) => (side === 'A' ? runs.a : runs.b).finished) ? '' : ' yet';
    return `${join_names(without)} ${without.length === 1 ? 'has' : 'have'} no result on the test set${yet}, so no side is better.`;
  }
  const shown = get_shown(a.quantity as Quantity);
  const unit = shown.unit === '' || shown.unit === '1' ? '' : ' ' + shown.unit;
  const text = (value: number | null): string => format_number(times(value, shown.factor), 4) + unit;
  if (a.value === b.value) {
    return `A and B have the same ${shown.name} on the test set: ${text(a.value)}.`;
  }
  const b_better = (b.value as number) < (a.value as number);
  const [better, worse] = b_better ? [b, a] : [a, b];
  const change = describe_change(worse.value as number, better.value as number);
  return (
    `${b_better ? 'B' : 'A'} has the smaller ${shown.name} on the test set: ${text(better.value)} against ${text(worse.value)}` +
    `${change === '' ? '' : ` (${change})`}.`
  );
}

function describe_failures({ a, b }: ComparedRuns): string {
  const [failed_a, failed_b] = [a.headline.failures, b.headline.failures];
  if (!failed_a && !failed_b) {
    return '';
  }
  return `Failed test cases: A ${failed_a ?? 'unknown'}, B ${failed_b ?? 'unknown'}.`;
}

function describe_pairs({ paired }: ComparedRuns): string {
  if (paired === null || paired.cases < 2) {
    return '';
  }
  const { wins, losses, cases, p, better } = paired;
  const counts = `A is better in ${wins} of ${cases} and B in ${losses}`;
  if (cases < kFewestPairs) {
    return `Case by case, ${counts}: not enough cases to decide; at least ${kFewestPairs} are needed.`;
  }
  const decision =
    better === null ? 'the cases do not tell the winners apart' : `by the ranks of the differences, ${better.toUpperCase()} is better`;
  return `Case by case, ${counts}; ${decision} (signed-rank test, p ${format_p(p).replace(/^(?=\d)/, '= ')}).`;
}

function describe_basis(data: ComparisonData, same_cases: boolean): string {
  const obstacles = find_obstacles(data.settings);
  if (obstacles.length === 0) {
    return 'The runs are comparable: problem, test set, engine and budget are the same.';
  }
  const differ = describe_obstacles(obstacles);
  return same_cases && obstacles.every((one) => one === 'the budget')
    ? `Both winners were tested on the same cases, but ${differ}.`
    : `Compare with care: ${differ}.`;
}

function make_headline(data: ComparisonData, runs: ComparedRuns): TextItem {
  const refusal = find_refusal(data, runs);
  const details = refusal !== '' ? [] : [describe_pairs(runs), describe_failures(runs), describe_basis(data, runs.same_cases)];
  return {
    kind: 'text',
    id: 'headline',
    title: 'Which one is better',
    style: 'headline',
    paragraphs: [
      refusal !== '' ? `The results of the runs cannot be compared: ${refusal}.` : describe_result(runs),
      details.filter((text) => text !== '').join(' '),
    ].filter((text) => text !== ''),
  };
}

// ---------------------------------------------------------------- side by side

function make_tiles(run: RunData, side: string): SummaryItem {
  return { ...make_tiles_item(run), id: 'tiles-' + side.toLowerCase(), title: `${side}: ${shorten(run.title, 60)}` };
}

function make_health(run: RunData, side: string): SummaryItem | null {
  const health = run.arm === null ? null : run.arm.health;
  return health === null
    ? null
    : { ...make_health_item(health), id: 'health-' + side.toLowerCase(), title: `Health of the winner of ${side}` };
}

function make_requirements(run: RunData, side: string): TableItem | null {
  const table = make_requirement_table(run.requirements);
  return table === null ? null : { ...table, id: 'requirements-' + side.toLowerCase(), title: `Requirements, ${side}` };
}

function measure_share(variable: VariableHistory, value: number): number | null {
  const sign = get_log_sign(variable);
  const to = (x: number): number => (sign === 0 ? x : sign * Math.log(sign * x));
  const share = (to(value) - to(variable.lower)) / (to(variable.upper) - to(variable.lower));
  return isFinite(share) ? share : null;
}

// Returns the change from A to B as a share of the range of A.
function measure_change(a: VariableHistory, b: VariableHistory | undefined): number | null {
  if (b === undefined || !is_number(a.winner) || !is_number(b.winner)) {
    return null;
  }
  const [from, to] = [measure_share(a, a.winner), measure_share(a, b.winner)];
  return from === null || to === null ? null : to - from;
}

export function make_variable_table({ a, b }: ComparedRuns): TableItem | null {
  const find = (list: VariableHistory[], name: string): VariableHistory | undefined => list.filter((one) => one.name === name)[0];
  const rows: (Value | Cell)[][] = a.variables.map((variable) => {
    const other = find(b.variables, variable.name);
    return [variable.name, variable.unit, variable.winner, other?.winner ?? null, times(measure_change(variable, other), 100)];
  });
  b.variables
    .filter((variable) => find(a.variables, variable.name) === undefined)
    .forEach((variable) => rows.push([variable.name, variable.unit, null, variable.winner, null]));
  if (rows.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'variables-compared',
    title: 'The designs of both winners',
    caption:
      'The change from A to B is a share of the range between the bounds of A. ' +
      'For variables with a logarithmic scale it is measured on that scale. A variable that only one run has was fixed in the other.',
    table: {
      columns: [
        { label: 'variable' },
        { label: 'unit' },
        { label: 'A', numeric: true, digits: 5 },
        { label: 'B', numeric: true, digits: 5 },
        { label: 'change, of the range', unit: '%', numeric: true, digits: 3 },
      ],
      rows,
    },
  };
}

// ---------------------------------------------------------------- figures

interface Course {
  name: string;
  style: number;
  cases: number[];
  values: (number | null)[];
  step: boolean;
}

function list_courses(runs: ComparedRuns, factor: number): Course[] {
  const courses: Course[] = [];
  [runs.a, runs.b].forEach(({ training }, i) => {
    const { incumbents } = training;
    const scaled = (values: (number | null)[]): (number | null)[] => values.map((value) => times(value, factor));
    courses.push({ name: `${kSides[i]}: best in training`, style: i, cases: training.cases, values: scaled(training.best), step: false });
    if (incumbents.test.some(is_number)) {
      courses.push({
        name: `${kSides[i]}: incumbent on the test set`,
        style: i,
        cases: incumbents.cases,
        values: scaled(incumbents.test),
        step: true,
      });
    }
  });
  return courses.filter((one) => one.values.some(is_number));
}

export function make_course_figure(runs: ComparedRuns): Figure | null {
  if (!are_same(runs.a.quantity, runs.b.quantity)) {
    return null;
  }
  const shown = get_shown(runs.a.quantity);
  const courses = list_courses(runs, shown.factor);
  if (courses.length === 0) {
    return null;
  }
  const all = flatten(courses.map((one) => one.values));
  const log = !runs.a.logarithmic && are_positive(all);
  return {
    kind: 'figure',
    id: 'courses',
    title: `Training of both runs: ${shown.name}`,
    caption:
      `The best ${shown.name} of each generation or block of evaluations, against the simulated training cases. Smaller values are better. ` +
      'The steps with symbols are the incumbents on the test set. Only these show the quality of a design.',
    width: 'full',
    height: 380,
    draw: (look) =>
      make_curve_plot(
        look,
        make_number_axis(look, 'x', 'simulated training cases', { max: 'dataMax' }),
        make_number_axis(look, 'y', name_axis(shown.name, shown.unit), { log, values: all }),
        courses.map((one): Part => {
          const points: Point[] = one.values.map((value, i) => [one.cases[i], value]);
          const style = get_series_style(look, one.style);
          return one.step
            ? { ...make_line(look, 0, one.name, points, { symbols: true, step: 'end', style, width: 2 }), showAllSymbol: true }
            : make_line(look, 0, one.name, points, { style: { ...style, dash: 'dotted' }, width: 1.4 });
        }),
      ),
    table: () => ({
      columns: [{ label: 'curve' }, { label: 'cases', numeric: true, digits: 8 }, { label: shown.name, unit: shown.unit, numeric: true }],
      rows: flatten(courses.map((one) => one.values.map((value, i): Value[] => [one.name, one.cases[i], value]))),
    }),
  };
}

// Returns the errors of both winners as those of two designs; null without both.
function join_errors({ a, b }: ComparedRuns): TestErrors | null {
  const [first, second] = [a.test, b.test];
  if (
    first === null ||
    second === null ||
    first.designs.length === 0 ||
    second.designs.length === 0 ||
    !are_same(first.quantity, second.quantity)
  ) {
    return null;
  }
  const set = first.set === second.set ? first.set : `${first.set} (A) and ${second.set} (B)`;
  const engine = first.engine === second.engine ? first.engine : `${first.engine} (A) and ${second.engine} (B)`;
  return { ...first, set, engine, designs: [first, second].map((test, i) => ({ ...test.designs[0], name: `winner of ${kSides[i]}` })) };
}

// Each test case as a point: the error of A and that of B.
function make_case_pairs_figure(test: TestErrors): Figure | null {
  const shown = get_shown(test.quantity);
  const [a, b] = test.designs.map((design) => design.errors.map((error) => times(error, shown.factor)));
  const rows = a.map((error, i): [number, number | null, number | null] => [i, error, b[i] ?? null]);
  const both = rows.filter((row) => is_number(row[1]) && is_number(row[2]));
  if (both.length < 2) {
    return null;
  }
  const values = flatten(both.map((row) => [row[1], row[2]]));
  const log = are_positive(values);
  const low = Math.min(...(values as number[]));
  const high = Math.max(...(values as number[]));
  const name = (side: string): string => name_axis(`${shown.name}, ${side}`, shown.unit);
  return {
    kind: 'figure',
    id: 'case-pairs',
    title: 'Test cases of both winners',
    caption:
      `Each point is one of ${count_of(both.length, 'test case')} that both winners were tested on. Below the line B is better, above it A. ` +
      (both.length < rows.length ? 'Cases without a number on either side are left out. ' : '') +
      'Points far from the line are the cases to look at in the replay.',
    draw: (look) =>
      make_plot(look, make_number_axis(look, 'x', name('A'), { log, values }), make_number_axis(look, 'y', name('B'), { log, values }), [
        {
          type: 'scatter',
          name: 'test case',
          data: both.map(([i, x, y]) => ({
            value: [x, y],
            note: `${test.set}, case ${i}: A ${format_number(x)}, B ${format_number(y)} ${shown.unit}`,
          })),
          symbolSize: 5,
          itemStyle: { color: look.series[0], opacity: 0.6 },
        },
        {
          ...make_line(look, 1, 'equal', [
            [low, low],
            [high, high],
          ]),
          lineStyle: { color: look.muted, type: 'dashed', width: 1.2 },
          silent: true,
        },
      ]),
    table: () => ({
      columns: [
        { label: 'case', numeric: true, digits: 8 },
        { label: 'A', unit: shown.unit, numeric: true },
        { label: 'B', unit: shown.unit, numeric: true },
      ],
      rows,
    }),
  };
}

function make_response({ a, b }: ComparedRuns): Figure | null {
  const [first, second] = [a, b].map((run) => (run.arm === null ? undefined : run.arm.response));
  if (first === undefined || second === undefined || first.series.length === 0 || second.series.length === 0) {
    return null;
  }
  if (String(first.distances_m) !== String(second.distances_m)) {
    return null;
  }
  const series = [first, second].map((one, i) => ({ ...one.series[0], name: `winner of ${kSides[i]}` }));
  return make_response_figure({ ...first, series }, 'distance-response');
}

// ---------------------------------------------------------------- the page

export function make_compared_run_tabs(data: ComparisonData, runs: ComparedRuns): Tab[] {
  const set = data.replays[0];
  const robot = set ? data.robots[set.robot] : undefined;
  const test = join_errors(runs);
  const errors = test === null ? null : make_errors_figure(test);
  const course = find_refusal(data, runs) !== '' ? null : make_course_figure(runs);
  const both = (make_one: (run: RunData, side: string) => Item | null): (Item | null)[] => [make_one(runs.a, 'A'), make_one(runs.b, 'B')];
  return keep_filled([
    {
      id: 'overview',
      title: 'Overview',
      items: [
        make_headline(data, runs),
        ...both(make_tiles),
        make_differences_table(data.settings),
        course === null ? null : { ...course, id: 'overview-courses', width: 'half', height: 340 },
        errors === null ? null : { ...errors, id: 'overview-errors' },
        ...both(make_health),
        ...both(make_requirements),
      ],
    },
    { id: 'training', title: 'Training', items: [course] },
    {
      id: 'response',
      title: 'Response',
      items: [
        errors,
        test === null || !runs.same_cases ? null : make_case_pairs_figure(test),
        make_response(runs),
        test === null ? null : make_failures_table(test),
      ],
    },
    {
      id: 'motion',
      title: 'Motion',
      items: set
        ? [
            { kind: 'replay', id: 'replay', title: 'Replay', sets: data.replays },
            ...make_joint_figures(set, robot),
            make_momentary_figure(set),
          ]
        : [],
    },
    { id: 'design', title: 'Design', items: [make_variable_table(runs)] },
    { id: 'settings', title: 'Settings', items: [make_differences_settings(data), make_equal_table(data.settings)] },
  ]);
}

function make_differences_settings(data: ComparisonData): TableItem | null {
  const table = make_differences_table(data.settings);
  return table === null ? null : { ...table, id: 'all-differences', caption: '' };
}
