// The tables of a comparison.
import { get_value } from '../csv';
import type { StudyOptimizerResult, StudyProblem } from '../data';
import type { Cell, Column, DataTable, TableItem, Value } from '../model';
import { convert, describe_size, end_title, get_curve_name, get_order, get_unit, type Scope, sort_by, type Unit } from './study_parts';
import { tabulate_pairs } from './study_pairs';

type Row = (Value | Cell)[];

// Returns the rows of all problems under one head. With several problems the table has a column for
// the problem, and one for the unit if units differ.
function tabulate(
  scope: Scope,
  get_problem_unit: (problem: StudyProblem) => Unit,
  make_columns: (unit: string) => Column[],
  make_rows: (problem: StudyProblem, unit: Unit) => Row[],
): DataTable {
  const units = scope.problems.map((problem) => get_problem_unit(problem).unit);
  const one_unit = units.every((unit) => unit === units[0]);
  const many = scope.problems.length > 1;
  const head: Column[] = (many ? [{ label: 'problem' }] : []).concat(one_unit ? [] : [{ label: 'unit' }]);
  return {
    columns: head.concat(make_columns(one_unit ? (units[0] ?? '') : '')),
    rows: scope.problems.reduce((all, problem, i) => {
      const before: Row = (many ? [problem.label] : []).concat(one_unit ? [] : [units[i]]);
      return all.concat(make_rows(problem, get_problem_unit(problem)).map((row) => before.concat(row)));
    }, [] as Row[]),
  };
}

// Returns the table without those of the named columns that have no value in any row.
function drop_empty_columns(table: DataTable, labels: string[]): DataTable {
  const has_value = (i: number) => table.rows.some((row) => get_value(row[i]) !== null && get_value(row[i]) !== '');
  const kept = table.columns.map((_, i) => i).filter((i) => labels.indexOf(table.columns[i].label) < 0 || has_value(i));
  return { columns: kept.map((i) => table.columns[i]), rows: table.rows.map((row) => kept.map((i) => row[i])) };
}

const get_value_unit = (problem: StudyProblem) => get_unit(problem.quantity);

// The command of the best design's run makes the design again.
function make_best_cell(value: number | null, replicate: number, result: StudyOptimizerResult): Cell {
  const run = result.cells.filter((cell) => cell.replicate === replicate)[0];
  return { value, note: `The best design is that of replicate ${replicate}.`, command: run?.command || undefined };
}

export function make_ranking_table(scope: Scope): TableItem {
  const columns = (unit: string): Column[] => [
    { label: 'optimizer' },
    { label: 'median', unit, numeric: true },
    { label: 'lower quartile', unit, numeric: true },
    { label: 'upper quartile', unit, numeric: true },
    { label: 'median, 95 % from', unit, numeric: true },
    { label: 'to', unit, numeric: true },
    { label: 'mean rank', numeric: true, digits: 3 },
    { label: 'anytime area', numeric: true, digits: 3 },
    { label: 'runs', numeric: true, digits: 9 },
    { label: 'no value', numeric: true, digits: 9 },
    { label: 'infeasible', numeric: true, digits: 9 },
    { label: 'failed', numeric: true, digits: 9 },
    { label: 'cases, median', numeric: true, digits: 9 },
    { label: 'checked on' },
    { label: 'best design there', unit, numeric: true },
    { label: 'failures there', numeric: true, digits: 9 },
    { label: 'successes', numeric: true, digits: 9 },
  ];
  const rows = (problem: StudyProblem, unit: Unit): Row[] =>
    get_order(scope, problem).map((o) => {
      const one = problem.results[o];
      const check = one.final_check;
      return [
        scope.names[o],
        convert(one.median, unit),
        convert(one.q1, unit),
        convert(one.q3, unit),
        convert(one.median_interval[0], unit),
        convert(one.median_interval[1], unit),
        one.mean_rank,
        one.anytime_area,
        one.cells.length,
        one.infinite,
        one.infeasible,
        one.failed,
        one.cases,
        check ? check.engine : null,
        check ? make_best_cell(convert(check.value, unit), check.replicate, one) : null,
        check ? check.failures : null,
        one.successes,
      ];
    });
  const tests = scope.problems
    .map((problem) =>
      problem.friedman
        ? (scope.problems.length > 1 ? problem.label.slice(0, 40) + ': ' : '') +
          'F = ' +
          (problem.friedman.statistic === null ? 'infinite' : problem.friedman.statistic.toFixed(1)) +
          ', p = ' +
          problem.friedman.p.toPrecision(2)
        : '',
    )
    .filter((text) => text !== '');
  return {
    kind: 'table',
    id: 'ranking' + scope.suffix,
    title: end_title(scope, 'Ranking'),
    caption:
      'Values on the test set, best mean rank first. A success is a run within the resolution of the known optimum; if the optimum is not known, it is a run with a value. A run without a value counts as the worst. A dash is a median or quartile that does not exist for this reason. ' +
      'Intervals are bootstrapped. If another engine is named, the best design of each optimizer, by the validation set, was simulated again on that engine. ' +
      describe_size(scope) +
      (tests.length > 0 && tests.length <= 6
        ? " Friedman's test, in the form of Iman and Davenport, says whether the optimizers differ at all: " + tests.join('; ') + '.'
        : ''),
    table: drop_empty_columns(tabulate(scope, get_value_unit, columns, rows), [
      'mean rank',
      'checked on',
      'best design there',
      'failures there',
    ]),
  };
}

export function make_pairs_table(scope: Scope): TableItem {
  return {
    kind: 'table',
    id: 'pairs-table' + scope.suffix,
    title: end_title(scope, 'Tests of every two optimizers'),
    caption:
      "Wilcoxon's signed-rank test over the replicates, with Holm's correction over all pairs of a problem, and A12 of Vargha and Delaney, the probability that a run of a is better than a run of b. Two optimizers that are not told apart need not be equal. " +
      describe_size(scope),
    table: tabulate_pairs(scope, scope.problems),
  };
}

export function make_cells_table(scope: Scope): TableItem {
  const columns = (unit: string): Column[] => [
    { label: 'optimizer' },
    { label: 'replicate', numeric: true, digits: 9 },
    { label: 'value', unit, numeric: true },
    { label: 'cases', numeric: true, digits: 9 },
    { label: 'evaluations', numeric: true, digits: 9 },
    { label: 'time taken', unit: 's', numeric: true },
    { label: 'CPU time', unit: 's', numeric: true },
    { label: 'failed test cases', numeric: true, digits: 9 },
    { label: "optimizer's failure" },
    { label: 'folder' },
  ];
  const rows = (problem: StudyProblem, unit: Unit): Row[] =>
    get_order(scope, problem).reduce(
      (all, o) =>
        all.concat(
          problem.results[o].cells.map((cell): Row => {
            const value = convert(cell.value, unit);
            return [
              scope.names[o],
              cell.replicate,
              { value, command: cell.command, note: value === null ? 'no value' : undefined },
              cell.cases,
              cell.evaluations,
              cell.wall_s,
              cell.cpu_s,
              cell.failures,
              cell.failure,
              cell.folder,
            ];
          }),
        ),
      [] as Row[],
    );
  const has_times = scope.problems.some((problem) => problem.results.some((one) => one.cells.some((cell) => cell.wall_s !== null)));
  return {
    kind: 'table',
    id: 'cells' + scope.suffix,
    title: end_title(scope, 'Every run'),
    caption:
      'All runs that have ended, each with the command that makes it again, bit for bit. The value is that of the winner on the test set; a dash means that there is none. ' +
      (has_times ? 'The times depend on the machine and are not part of the comparison. ' : '') +
      describe_size(scope),
    table: drop_empty_columns(tabulate(scope, get_value_unit, columns, rows), ['time taken', 'CPU time', "optimizer's failure"]),
  };
}

export function make_running_times_table(scope: Scope): TableItem {
  const columns = (unit: string): Column[] => [
    { label: 'optimizer' },
    { label: 'target', unit, numeric: true },
    { label: 'runs that reached it', numeric: true, digits: 9 },
    { label: 'runs', numeric: true, digits: 9 },
    { label: 'expected running time', unit: 'cases', numeric: true, digits: 6 },
    { label: '95 % from', unit: 'cases', numeric: true, digits: 6 },
    { label: 'to', unit: 'cases', numeric: true, digits: 6 },
  ];
  const rows = (problem: StudyProblem, unit: Unit): Row[] =>
    get_order(scope, problem).reduce(
      (all, o) =>
        all.concat(
          problem.results[o].running_times.map((time): Row => [
            scope.names[o],
            convert(time.target, unit),
            time.reached,
            problem.results[o].cells.length,
            time.expected,
            time.interval[0],
            time.interval[1],
          ]),
        ),
      [] as Row[],
    );
  return {
    kind: 'table',
    id: 'running-times' + scope.suffix,
    title: end_title(scope, 'Expected running times'),
    caption:
      'The average number of simulated cases that reaching a target would need, with a new start and other random numbers after each run that fails. It is the number of all cases spent, divided by the number of runs that reached the target. ' +
      'A dash means that no run reached the target. ' +
      describe_size(scope),
    table: tabulate(scope, (problem) => get_curve_name(problem).unit, columns, rows),
  };
}

// The targets of the study itself, if it has any for these problems.
export function make_targets_table(scope: Scope): TableItem | null {
  const reference = scope.data.reference;
  const times: Column[] = [
    { label: 'target' },
    { label: 'optimizer' },
    { label: 'runs that reached it', numeric: true, digits: 9 },
    { label: 'kept to the end', numeric: true, digits: 9 },
    { label: 'runs', numeric: true, digits: 9 },
    { label: 'expected running time', unit: 'cases', numeric: true, digits: 6 },
    { label: '95 % from', unit: 'cases', numeric: true, digits: 6 },
    { label: 'to', unit: 'cases', numeric: true, digits: 6 },
  ];
  const ratios: Column[] = [
    { label: 'times ' + reference, numeric: true, digits: 3 },
    { label: '95 % from', numeric: true, digits: 3 },
    { label: 'to', numeric: true, digits: 3 },
  ];
  const columns = () => (reference ? times.concat(ratios) : times);
  const rows = (problem: StudyProblem): Row[] =>
    problem.fixed_targets.reduce((all, target, t) => {
      const time_of = (o: number) => problem.results[o].target_times[t];
      const order = sort_by(get_order(scope, problem), (o) => time_of(o).expected ?? Infinity);
      return all.concat(
        order.map((o): Row => {
          const time = time_of(o);
          const runs = problem.results[o].cells.length;
          const row: Row = [target, scope.names[o], time.reached, time.kept, runs, time.expected, time.interval[0], time.interval[1]];
          return reference ? row.concat([time.ratio, time.ratio_interval[0], time.ratio_interval[1]]) : row;
        }),
      );
    }, [] as Row[]);
  if (scope.problems.every((problem) => problem.fixed_targets.length === 0)) {
    return null;
  }
  return {
    kind: 'table',
    id: 'targets' + scope.suffix,
    title: end_title(scope, 'Fixed targets'),
    caption:
      'The average number of simulated cases until the best design so far, by the validation set, meets a target on the test set. It is the number of all cases spent, divided by the number of runs that met the target. ' +
      'The column "kept to the end" counts the runs whose winner also meets the target. A dash is a time without a bound. ' +
      describe_size(scope),
    table: tabulate(scope, () => ({ unit: '', factor: 1 }), columns, rows),
  };
}

// The results of the optimizers over all problems.
export function make_overall_table(scope: Scope): TableItem | null {
  const overall = scope.data.overall;
  if (!overall) {
    return null;
  }
  const problems = scope.data.problems;
  const columns: Column[] = [
    { label: 'optimizer' },
    { label: 'mean rank', numeric: true, digits: 3 },
    { label: 'from', numeric: true, digits: 3 },
    { label: 'to', numeric: true, digits: 3 },
  ].concat(
    problems.map((problem) => ({
      label: 'median, ' + problem.label,
      unit: get_value_unit(problem).unit,
      numeric: true,
      digits: 4,
    })) as never[],
  );
  const order = sort_by(scope.shown, (i) => overall.mean_ranks[i] ?? Infinity);
  return {
    kind: 'table',
    id: 'overall',
    title: 'Ranking over problems',
    caption:
      'The mean ranks of the medians, where each problem counts once, and the medians on the test set. A dash is a median without a value. ' +
      (overall.rank_intervals ? 'The intervals are those of the mean ranks. ' : '') +
      'Ranks depend on the optimizers that take part. ' +
      describe_size(scope),
    table: drop_empty_columns(
      {
        columns,
        rows: order.map((o) => {
          const interval = overall.rank_intervals ? overall.rank_intervals[o] : null;
          const row: Row = [scope.names[o], overall.mean_ranks[o] ?? null, interval ? interval[0] : null, interval ? interval[1] : null];
          return row.concat(problems.map((problem) => convert(problem.results[o]?.median, get_value_unit(problem))));
        }),
      },
      ['from', 'to'],
    ),
  };
}
