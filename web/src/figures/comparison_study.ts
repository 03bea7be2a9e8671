// The page that compares two studies: the optimizers and problems that both have, and whether the
// replicates tell their results apart.
import { join_names, shorten, shorten_all } from '../charts/names';
import type { ComparedCell, ComparedStudies, ComparisonData, StudyData, StudyProblem } from '../data';
import type { Cell, Figure, Item, Tab, TableItem, TextItem, Value } from '../model';
import { format_number } from '../numbers';
import {
  describe_change,
  describe_obstacles,
  find_differences,
  find_obstacles,
  make_differences_table,
  make_equal_table,
} from './comparison_parts';
import { count_of, is_number } from './quantities';
import { keep_filled } from './run_page';
import { make_headline as make_study_headline } from './study_headline';
import { draw_squares, format_p, get_a12_color } from './study_pairs';
import { convert, describe_value, get_unit, make_scope, type Scope } from './study_parts';
import { make_convergence } from './study_progress';
import { make_values } from './study_values';

type Verdict = 'a' | 'b' | 'open' | 'untested';

function get_verdict(cell: ComparedCell): Verdict {
  return cell.p === null ? 'untested' : (cell.better ?? 'open');
}

const kStates: { [verdict in Verdict]: { text: string; mark: NonNullable<Cell['mark']> } } = {
  a: { text: '◀ A is better', mark: 'good' },
  b: { text: '▶ B is better', mark: 'good' },
  open: { text: '= not told apart', mark: 'none' },
  untested: { text: '? no test', mark: 'none' },
};

function describe_verdict(cell: ComparedCell): string {
  return kStates[get_verdict(cell)].text + (cell.untested === null ? '' : `: ${cell.untested}`);
}

// ---------------------------------------------------------------- the headline

function count(cells: ComparedCell[], verdict: Verdict): number {
  return cells.filter((cell) => get_verdict(cell) === verdict).length;
}

// Returns "B is better for ga on q1 and q2", one clause per optimizer.
function list_wins(cells: ComparedCell[], side: 'a' | 'b'): string {
  const won = cells.filter((cell) => get_verdict(cell) === side);
  const names = won.map((cell) => shorten(cell.optimizer)).filter((name, i, all) => all.indexOf(name) === i);
  const clauses = names.map((name) => {
    const problems = won.filter((cell) => shorten(cell.optimizer) === name).map((cell) => shorten(cell.problem));
    return `${name} on ${problems.length > 3 ? count_of(problems.length, 'problem') : join_names(problems)}`;
  });
  const shown = clauses.length > 4 ? [...clauses.slice(0, 3), `${clauses.length - 3} more optimizers`] : clauses;
  return `${side.toUpperCase()} is better for ${join_names(shown)}`;
}

// Returns why there is nothing to compare.
function describe_nothing(data: ComparisonData, { a, b }: ComparedStudies): string {
  const value = find_differences(data.settings).filter((one) => one.name === 'value')[0];
  if (value !== undefined) {
    return `The studies cannot be compared, because the values of their runs have different meanings: ${value.a} in A, ${value.b} in B.`;
  }
  const both = a.problems.filter((one) => b.problems.some((other) => other.label === one.label));
  if (both.length === 0 || !a.optimizers.some((one) => b.optimizers.some((other) => other.label === one.label))) {
    return 'The studies have no optimizer and problem in common, so there is nothing to compare.';
  }
  return 'The studies cannot be compared, because no problem that both have has values with the same meaning.';
}

function describe_result(data: ComparisonData, studies: ComparedStudies): string {
  const { cells } = studies;
  if (cells.length === 0) {
    return describe_nothing(data, studies);
  }
  const untested = cells.filter((cell) => get_verdict(cell) === 'untested');
  const reasons = join_names(untested.map((cell) => cell.untested ?? '').filter((one, i, all) => all.indexOf(one) === i));
  if (untested.length === cells.length) {
    return `No test can tell the studies apart: ${reasons}.`;
  }
  const others = untested.length === 0 ? '' : ` ${count_of(untested.length, 'result')} without a test: ${reasons}.`;
  const tested = cells.length - untested.length;
  const common = untested.length === 0 ? 'both have' : tested === 1 ? 'has a test' : 'have a test';
  const clauses = (['a', 'b'] as const).filter((side) => count(cells, side) > 0).map((side) => list_wins(cells, side));
  const open = count(cells, 'open');
  if (clauses.length === 0) {
    return `No result of A can be told apart from that of B, for ${tested === 1 ? 'the one optimizer and problem that' : `all ${tested} pairs of optimizer and problem that`} ${common}.${others}`;
  }
  const rest = open === 0 ? '' : `; the other ${open === 1 ? 'result' : open + ' results'} cannot be told apart`;
  return clauses.join('; ') + rest + '.' + others;
}

function describe_basis(data: ComparisonData): string {
  const obstacles = find_obstacles(data.settings);
  const differences = find_differences(data.settings);
  if (differences.length === 0) {
    return 'The studies have the same settings.';
  }
  return obstacles.length === 0
    ? `The studies are comparable: problems, test sets, engines and budget are the same. ${count_of(differences.length, 'other setting')} ` +
        `${differences.length === 1 ? 'differs' : 'differ'}.`
    : `Compare with care: ${describe_obstacles(obstacles)}.`;
}

function describe_common({ a, b }: ComparedStudies): string {
  const only = (mine: string[], theirs: string[]): string[] => mine.filter((name) => theirs.indexOf(name) < 0).map((name) => shorten(name));
  const optimizers = [a, b].map((study) => study.optimizers.map((one) => one.label));
  const problems = [a, b].map((study) => study.problems.map((one) => one.label));
  const parts: string[] = [];
  ['A', 'B'].forEach((side, i) => {
    const missing = [...only(optimizers[i], optimizers[1 - i]), ...only(problems[i], problems[1 - i])];
    if (missing.length > 0) {
      parts.push(`Only ${side} has ${missing.length > 6 ? count_of(missing.length, 'other optimizer and problem') : join_names(missing)}.`);
    }
  });
  return parts.join(' ');
}

function make_headline(data: ComparisonData, studies: ComparedStudies): TextItem {
  return {
    kind: 'text',
    id: 'headline',
    title: 'Which one is better',
    style: 'headline',
    paragraphs: [describe_result(data, studies), [describe_basis(data), describe_common(studies)].filter((text) => text !== '').join(' ')],
  };
}

// ---------------------------------------------------------------- the grid

function describe_side(side: ComparedCell['a'], cell: ComparedCell): string {
  const unit = get_unit(cell.quantity);
  const spread =
    is_number(side.q1) && is_number(side.q3)
      ? ` (${format_number(convert(side.q1, unit))} to ${format_number(convert(side.q3, unit))})`
      : '';
  return describe_value(side.median, unit) + spread;
}

// Returns whether the middle halves of the replicates of both sides overlap.
function do_quartiles_overlap({ a, b }: ComparedCell): boolean | null {
  return is_number(a.q1) && is_number(a.q3) && is_number(b.q1) && is_number(b.q3) ? a.q1 <= b.q3 && b.q1 <= a.q3 : null;
}

// Returns the problems and optimizers at a glance; null if there is nothing to compare.
function make_grid_figure(cells: ComparedCell[]): Figure | null {
  const list = (get: (cell: ComparedCell) => string): string[] => cells.map(get).filter((one, i, all) => all.indexOf(one) === i);
  const [problems, optimizers] = [list((cell) => cell.problem), list((cell) => cell.optimizer)];
  if (cells.length === 0) {
    return null;
  }
  const describe = (cell: ComparedCell): string =>
    `${shorten(cell.optimizer)} on ${shorten(cell.problem)}; A ${describe_side(cell.a, cell)}, B ${describe_side(cell.b, cell)}; ` +
    (cell.p_holm === null ? '' : `p = ${format_p(cell.p_holm)} after Holm; `) +
    describe_verdict(cell).slice(2);
  return {
    kind: 'figure',
    id: 'compared-grid',
    title: 'Where A and B differ',
    caption:
      'The number is A12, the probability that a run of A is better than a run of B: blue where A is better, orange where B is. ' +
      'A bold number with a bar is decided by the test. The table has the medians.' +
      (problems.length > 1 ? ' The columns are ' + join_names(shorten_all(problems).map((name, i) => `${i + 1}: ${name}`)) + '.' : ''),
    width: 'full',
    height: Math.min(900, Math.max(200, 80 + 26 * optimizers.length)),
    draw: (look) =>
      draw_squares(
        look,
        problems.length > 1 ? problems.map((_, i) => String(i + 1)) : shorten_all(problems),
        shorten_all(optimizers),
        cells.map((cell) => ({ value: [problems.indexOf(cell.problem), optimizers.indexOf(cell.optimizer)], note: describe(cell) })),
        cells.map((cell) => ({
          fill: cell.a12 === null ? look.background : get_a12_color(look, cell.a12),
          text: cell.a12 === null ? '–' : cell.a12.toFixed(2),
          marked: cell.better !== null,
        })),
        ['A12 = 1\nA better', 'B better\nA12 = 0'],
      ),
    table: () => (make_grid(cells) as TableItem).table,
  };
}

export function make_grid(cells: ComparedCell[]): TableItem | null {
  if (cells.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'compared-cells',
    title: 'Problems and optimizers of both studies',
    caption:
      'Medians with the quartiles of the replicates. The test is the signed-rank test of the pairs of replicates with the same number, ' +
      "with Holm's correction over all rows; only where p is below 0.05 the sides are told apart. " +
      'A12 is the probability that a run of A is better than a run of B: 0.5 is no difference. ' +
      'Replicates form pairs if both studies have the same seed, spread of starts, and settings of the problem.',
    table: {
      columns: [
        { label: 'problem' },
        { label: 'optimizer' },
        { label: 'result' },
        { label: 'median of A' },
        { label: 'median of B' },
        { label: 'change' },
        { label: 'quartiles overlap' },
        { label: 'A12', numeric: true, digits: 2 },
        { label: 'p, Holm' },
        { label: 'pairs', numeric: true },
      ],
      rows: cells.map((cell): (Value | Cell)[] => {
        const overlap = do_quartiles_overlap(cell);
        return [
          cell.problem,
          cell.optimizer,
          { value: describe_verdict(cell), mark: kStates[get_verdict(cell)].mark },
          describe_side(cell.a, cell),
          describe_side(cell.b, cell),
          is_number(cell.a.median) && is_number(cell.b.median) ? describe_change(cell.a.median, cell.b.median) : '',
          overlap === null ? '' : overlap ? 'yes' : 'no',
          cell.a12,
          cell.p_holm === null ? '' : format_p(cell.p_holm),
          cell.pairs,
        ];
      }),
    },
  };
}

// ---------------------------------------------------------------- figures

// Returns the common optimizers of both studies as those of one study, for the problems whose curves
// have the same checkpoints; null if there are none.
export function join_studies({ a, b }: ComparedStudies): Scope | null {
  const common = a.optimizers.map((one) => one.label).filter((label) => b.optimizers.some((one) => one.label === label));
  const places = [a, b].map((study) => common.map((label) => study.optimizers.map((one) => one.label).indexOf(label)));
  const problems: StudyProblem[] = [];
  a.problems.forEach((problem) => {
    const other = b.problems.filter((one) => one.label === problem.label)[0];
    const same =
      other !== undefined &&
      !problem.has_front &&
      !other.has_front &&
      String(other.checkpoints) === String(problem.checkpoints) &&
      other.quantity.name === problem.quantity.name;
    if (same && common.length > 0) {
      const results = [...places[0].map((o) => problem.results[o]), ...places[1].map((o) => other.results[o])];
      const order: number[] = [];
      common.forEach((_, i) => order.push(i, common.length + i));
      problems.push({ ...problem, results, order, pairs: [], friedman: null, front: null, missing: problem.missing + other.missing });
    }
  });
  if (problems.length === 0) {
    return null;
  }
  const optimizers = ['A', 'B'].reduce(
    (all, side) => all.concat(common.map((label) => ({ label: `${side}: ${label}`, name: label }))),
    [] as StudyData['optimizers'],
  );
  return make_scope({ ...a, optimizers, problems, overall: null, replicates: Math.min(a.replicates, b.replicates) }, problems, '');
}

function make_verdict(study: StudyData, side: string): TextItem {
  return {
    kind: 'text',
    id: 'verdict-' + side.toLowerCase(),
    title: `The verdict of ${side}: ${shorten(study.title, 60)}`,
    paragraphs: [make_study_headline(make_scope(study, study.problems, ''))],
  };
}

export function make_compared_study_tabs(data: ComparisonData, studies: ComparedStudies): Tab[] {
  const scope = join_studies(studies);
  const figures: (Figure | null)[] = scope === null ? [] : [make_convergence(scope), make_values(scope)];
  const differences = make_differences_table(data.settings);
  const overview: (Item | null)[] = [
    make_headline(data, studies),
    make_grid_figure(studies.cells),
    make_grid(studies.cells),
    differences,
    make_verdict(studies.a, 'A'),
    make_verdict(studies.b, 'B'),
  ];
  return keep_filled([
    { id: 'overview', title: 'Overview', items: overview },
    { id: 'curves', title: 'Curves', items: figures },
    {
      id: 'settings',
      title: 'Settings',
      items: [differences === null ? null : { ...differences, id: 'all-differences', caption: '' }, make_equal_table(data.settings)],
    },
  ]);
}
