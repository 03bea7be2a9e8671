// How good optimizers become for how much budget: curves over the budget, and shares of targets and
// problems.
import type { EChartsOption } from '../charts/echarts';
import type { Look } from '../charts/look';
import { shorten_all } from '../charts/names';
import { make_band, make_line, type Part, type Point } from '../charts/parts';
import { make_grid_lines, make_scale, make_scaled_axis, type Scale } from '../charts/scales';
import type { StudyProblem } from '../data';
import type { Choice, DataTable, Figure, Picked, Value } from '../model';
import { format_number } from '../numbers';
import {
  convert_all,
  describe_size,
  describe_value,
  end_title,
  get_curve_name,
  get_order,
  get_picked,
  get_problem,
  get_ranks,
  get_style,
  kMostAtFirst,
  make_problem_choices,
  make_ranked_chart,
  make_symbol,
  name_axis,
  type Scope,
  sort_by,
  split_rows,
} from './study_parts';

// With more curves the bands of the quartiles would hide each other.
const kMostBands = 4;

const kCasesAxis = 'simulated training cases';
const kFirstOnes = (count: number) =>
  count > kMostAtFirst
    ? ' Of the ' + count + ' optimizers, the best ' + kMostAtFirst + ' are drawn at first. The legend switches them on and off.'
    : '';

function draw_convergence(look: Look, scope: Scope, problem: StudyProblem): EChartsOption {
  const { name, unit } = get_curve_name(problem);
  const order = get_order(scope, problem);
  const curves = order.map((o) => {
    const curve = problem.results[o].curve;
    return { q1: convert_all(curve.q1, unit), median: convert_all(curve.median, unit), q3: convert_all(curve.q3, unit) };
  });
  const drawn = curves.slice(0, kMostAtFirst);
  const has_bands = order.length <= kMostBands;
  const everything = (list: typeof curves) =>
    list.reduce((all, one) => all.concat(one.median, has_bands ? one.q1.concat(one.q3) : []), [] as (number | null)[]);
  // The axis has room for all series that can be switched on.
  const y = make_scale(everything(curves.length > 2 * kMostAtFirst ? drawn : curves), true);
  const x = make_scale(problem.checkpoints, true);
  // Lines come before bands, because the legend draws the first series of a name.
  const bands: Part[] = [];
  const series: Part[] = [make_grid_lines(look, x, y)];
  order.forEach((o, place) => {
    const { q1, median, q3 } = curves[place];
    const style = get_style(look, scope, o);
    const rows = problem.checkpoints.map((cases, i): [number, number, number] | null => {
      const low = q1[i] ?? null;
      // A quartile without a value is beyond the end of the axis.
      return low === null ? null : [cases, low, q3[i] ?? y.high * 10];
    });
    split_rows(has_bands ? rows : []).forEach((piece) => bands.push(make_band(scope.names[o], piece, style.color)));
    const points = problem.checkpoints.map((cases, i): Point => {
      const value = median[i] ?? null;
      const note =
        scope.names[o] +
        '; ' +
        cases +
        ' cases: median ' +
        describe_value(value, { factor: 1, unit: unit.unit }) +
        ', quartiles ' +
        format_number(q1[i]) +
        ' to ' +
        format_number(q3[i]);
      return { value: [cases, value], note };
    });
    series.push({
      ...make_line(look, 0, scope.names[o], points, { style, symbols: true, width: 2 }),
      ...make_symbol(look, style),
      symbolSize: 5,
      z: 3,
    });
  });
  const names = order.map((o) => scope.names[o]);
  return make_ranked_chart(
    look,
    make_scaled_axis(look, 'x', kCasesAxis, x),
    make_scaled_axis(look, 'y', name_axis(name, unit.unit), y),
    series.concat(bands),
    names,
    names.slice(0, kMostAtFirst),
  );
}

export function make_convergence(scope: Scope): Figure {
  const table = (picked: Picked): DataTable => {
    const problem = get_problem(scope, picked);
    const { unit } = get_curve_name(problem);
    const rows: Value[][] = [];
    get_order(scope, problem).forEach((o) => {
      const { q1, median, q3 } = problem.results[o].curve;
      const [low, middle, high] = [convert_all(q1, unit), convert_all(median, unit), convert_all(q3, unit)];
      problem.checkpoints.forEach((cases, i) => rows.push([scope.names[o], cases, middle[i] ?? null, low[i] ?? null, high[i] ?? null]));
    });
    return {
      columns: [
        { label: 'optimizer' },
        { label: 'cases', numeric: true, digits: 9 },
        { label: 'median', unit: unit.unit, numeric: true },
        { label: 'lower quartile', unit: unit.unit, numeric: true },
        { label: 'upper quartile', unit: unit.unit, numeric: true },
      ],
      rows,
    };
  };
  return {
    kind: 'figure',
    id: 'convergence' + scope.suffix,
    title: end_title(scope, 'Convergence'),
    caption:
      'The value of the incumbents on the test set against the number of simulated training cases. The line is the median over replicates. ' +
      (scope.shown.length <= kMostBands
        ? 'The band shows the quartiles. '
        : 'Bands of the quartiles are drawn for at most ' + kMostBands + ' optimizers; the table has the quartiles of all. ') +
      'Designs are chosen in training and simulated again on the test set, so a curve may rise. Where a curve is missing, half of the runs have no value yet. ' +
      'The order of the optimizers at one budget says nothing about another budget. ' +
      describe_size(scope) +
      kFirstOnes(scope.shown.length),
    height: 400,
    choices: make_problem_choices(scope),
    draw: (look, picked) => draw_convergence(look, scope, get_problem(scope, picked)),
    table,
  };
}

interface Steps {
  abscissae: number[];
  x_name: string;
  y_name: string;
  shares: number[][]; // one row per optimizer
  order: number[];
}

// Returns the index of the last abscissa at which all shares are still 0. The axis begins there. If
// all shares are 0 everywhere, it begins at the first one.
function find_first_shown(steps: Steps): number {
  for (let i = 0; i < steps.abscissae.length; ++i) {
    if (steps.order.some((o) => (steps.shares[o]?.[i] ?? 0) > 0)) {
      return Math.max(0, i - 1);
    }
  }
  return 0;
}

// Returns a scale from 0 to a round share that is not less than any of the drawn ones.
function make_share_scale(steps: Steps): Scale {
  const most = steps.order.reduce((all, o) => (steps.shares[o] ?? []).reduce((one, share) => Math.max(one, share), all), 0);
  const high = [0.1, 0.2, 0.5].filter((one) => most > 0 && one >= most)[0] ?? 1;
  return { log: false, low: 0, high, end: high, ticks: [0, 1, 2, 3, 4, 5].map((i) => Number((0.2 * i * high).toPrecision(3))) };
}

// Draws shares from 0 to 1 that never decrease.
function draw_steps(look: Look, scope: Scope, steps: Steps): EChartsOption {
  const first = find_first_shown(steps);
  const x = make_scale(steps.abscissae.slice(first), true);
  const y = make_share_scale(steps);
  const series: Part[] = [make_grid_lines(look, x, y)];
  steps.order.forEach((o) => {
    const points = steps.abscissae.slice(first).map((at, i): Point => {
      const share = steps.shares[o]?.[first + i] ?? null;
      return { value: [at, share], note: scope.names[o] + '; ' + format_number(at, 3) + ': ' + format_number(share, 3) };
    });
    const style = get_style(look, scope, o);
    const line = {
      ...make_line(look, 0, scope.names[o], points, { style, step: 'end', width: 2, symbols: true }),
      ...make_symbol(look, style),
    };
    // Marks at some points distinguish the steps. The other points are only for the pointer.
    const every = Math.ceil(points.length / 12);
    series.push({ ...line, symbolSize: (_: unknown, at: { dataIndex: number }) => (at.dataIndex % every === o % every ? 6 : 2) });
  });
  const names = steps.order.map((o) => scope.names[o]);
  return make_ranked_chart(
    look,
    make_scaled_axis(look, 'x', steps.x_name, x),
    make_scaled_axis(look, 'y', steps.y_name, y),
    series,
    names,
    names.slice(0, kMostAtFirst),
  );
}

function tabulate_steps(scope: Scope, steps: Steps): DataTable {
  const rows: Value[][] = [];
  steps.order.forEach((o) => steps.abscissae.forEach((at, i) => rows.push([scope.names[o], at, steps.shares[o]?.[i] ?? null])));
  return {
    columns: [{ label: 'optimizer' }, { label: steps.x_name, numeric: true, digits: 6 }, { label: steps.y_name, numeric: true }],
    rows,
  };
}

const kTargets =
  'Targets lie between the start and the best known value: the optimum if it is known, else the best value that any optimizer of this study found. They are spaced evenly on a logarithmic scale of the remaining way to that value, and depend on the optimizers that take part. ' +
  'A target counts as reached when all later incumbents reach it too. ';
const kPairsAxis = 'share of (run, target) pairs reached';

export function make_runtime_ecdf(scope: Scope): Figure {
  const get_steps = (picked: Picked): Steps => {
    const problem = get_problem(scope, picked);
    return {
      abscissae: problem.checkpoints,
      x_name: kCasesAxis,
      y_name: kPairsAxis,
      shares: problem.results.map((one) => one.ecdf),
      order: get_order(scope, problem),
    };
  };
  return {
    kind: 'figure',
    id: 'runtime-ecdf' + scope.suffix,
    title: end_title(scope, 'Targets reached over the budget'),
    caption:
      'The share of all pairs of a run and a target that are reached, against the number of simulated training cases. Curves that are higher and further left are better. ' +
      kTargets +
      describe_size(scope) +
      kFirstOnes(scope.shown.length),
    height: 400,
    choices: make_problem_choices(scope),
    draw: (look, picked) => draw_steps(look, scope, get_steps(picked)),
    table: (picked) => tabulate_steps(scope, get_steps(picked)),
  };
}

// Pools the (run, target) pairs of the problems. All runs of a problem have its targets, so a problem
// counts as often as it has targets. Between two of its checkpoints its share stays the same.
export function pool_ecdfs(problems: StudyProblem[]): { checkpoints: number[]; shares: number[][] } {
  const all = problems.reduce((list, one) => list.concat(one.checkpoints), [] as number[]);
  const checkpoints = sort_by(all, (at) => at).filter((at, i, sorted) => i === 0 || at !== sorted[i - 1]);
  const pairs = problems.reduce((sum, one) => sum + one.targets.length, 0);
  const optimizers = problems.length > 0 ? problems[0].results.map((_, o) => o) : [];
  const shares = optimizers.map((o) => {
    const places = problems.map(() => -1); // of the last checkpoint that is not beyond `at`
    return checkpoints.map((at) => {
      const reached = problems.map((one, p) => {
        while (places[p] + 1 < one.checkpoints.length && one.checkpoints[places[p] + 1] <= at) {
          ++places[p];
        }
        return (one.targets.length / pairs) * (places[p] < 0 ? 0 : (one.results[o].ecdf[places[p]] ?? 0));
      });
      return reached.reduce((sum, one) => sum + one, 0);
    });
  });
  return { checkpoints, shares };
}

// The share of pairs over all problems whose runs have ended. Returns null if there is only one.
export function make_pooled_ecdf(scope: Scope): Figure | null {
  const problems = scope.problems.filter((problem) => problem.missing === 0 && problem.targets.length > 0);
  if (problems.length < 2) {
    return null;
  }
  const labels = shorten_all(problems.map((problem) => problem.label));
  const choice: Choice = {
    id: 'problem',
    label: 'Problems',
    options: [{ value: 'all', label: 'all ' + problems.length + ' problems' }].concat(
      labels.map((label, i) => ({ value: String(i), label })),
    ),
    initial: 'all',
  };
  const get_steps = (picked: Picked): Steps => {
    const value = get_picked(choice, picked);
    const of = value === 'all' ? problems : [problems[Number(value)]];
    const { checkpoints, shares } = pool_ecdfs(of);
    return {
      abscissae: checkpoints,
      x_name: kCasesAxis,
      y_name: kPairsAxis,
      shares,
      order: value === 'all' ? order_by_mean_rank(scope) : get_order(scope, of[0]),
    };
  };
  return {
    kind: 'figure',
    id: 'pooled-ecdf',
    title: 'Targets reached over all problems',
    caption:
      'The share of all (run, target) pairs of ' +
      problems.length +
      ' problems that are reached, against the number of simulated training cases. Curves that are higher and further left are better. ' +
      kTargets +
      'Each problem has its own targets, and their number is its weight. ' +
      (problems.length < scope.problems.length ? 'Problems with missing runs are left out. ' : '') +
      describe_size({ ...scope, problems }) +
      kFirstOnes(scope.shown.length),
    width: 'full',
    height: 420,
    choices: [choice],
    draw: (look, picked) => draw_steps(look, scope, get_steps(picked)),
    table: (picked) => tabulate_steps(scope, get_steps(picked)),
  };
}

function order_by_mean_rank(scope: Scope): number[] {
  const ranks = get_ranks(scope.data);
  return sort_by(scope.shown, (i) => ranks[i] ?? Infinity);
}

// Returns the index of the tightest tolerance at which an optimizer solves half of the pairs, or of
// the loosest one. A tighter profile is nearly empty. Tolerances are in descending order.
function find_tightest(profiles: { shares: number[][] }[]): number {
  let tightest = 0;
  profiles.forEach((one, i) => {
    if (one.shares.some((shares) => shares[shares.length - 1] >= 0.5)) {
      tightest = i;
    }
  });
  return tightest;
}

function make_profile(
  scope: Scope,
  id: string,
  title: string,
  caption: string,
  x_name: string,
  abscissae: number[],
  profiles: { tolerance: number; shares: number[][] }[],
): Figure {
  const tolerance: Choice = {
    id: 'tolerance',
    label: 'Tolerance',
    options: profiles.map((one, i) => ({ value: String(i), label: format_number(one.tolerance, 1) })),
    initial: String(find_tightest(profiles)),
  };
  const order = order_by_mean_rank(scope);
  const get_steps = (picked: Picked): Steps => ({
    abscissae,
    x_name,
    y_name: 'share of (problem, replicate) pairs solved',
    shares: profiles[Number(get_picked(tolerance, picked))]?.shares ?? [],
    order,
  });
  return {
    kind: 'figure',
    id,
    title,
    caption: caption + ' ' + describe_size(scope) + kFirstOnes(scope.shown.length),
    height: 400,
    choices: [tolerance],
    draw: (look, picked) => draw_steps(look, scope, get_steps(picked)),
    table: (picked) => tabulate_steps(scope, get_steps(picked)),
  };
}

const kSolved =
  'A (problem, replicate) pair is solved when at most the share "tolerance" remains of the way from the start to the best value that any optimizer found there (Moré and Wild 2009). ';

export function make_profiles(scope: Scope): Figure[] {
  const overall = scope.data.overall;
  if (!overall) {
    return [];
  }
  return [
    make_profile(
      scope,
      'data-profile',
      'Data profile',
      kSolved +
        'The figure shows the share of solved pairs against the effort in simplex gradients. A simplex gradient is one evaluation more than the problem has variables. A curve says directly which share of these problems is solved with a given budget.',
      'simplex gradients',
      overall.kappas,
      overall.data_profiles,
    ),
    make_profile(
      scope,
      'performance-profile',
      'Performance profile',
      kSolved +
        'The figure shows the share of pairs that are solved within a multiple of the cost of the fastest optimizer there. The value at 1 says how often an optimizer was the fastest, ties included. The value at the right says how often it solved a pair at all. ' +
        'The multiples depend on the optimizers that take part: if the fastest one is left out, two others may change places.',
      'cost, as a multiple of the smallest',
      overall.alphas,
      overall.performance_profiles,
    ),
  ];
}
