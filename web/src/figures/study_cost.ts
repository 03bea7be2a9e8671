// The cost of an optimizer against the quality of its result.
import type { EChartsOption } from '../charts/echarts';
import { make_labels } from '../charts/labels';
import type { Look } from '../charts/look';
import { make_grid_lines, make_scale, make_scaled_axis, place_on } from '../charts/scales';
import type { StudyProblem } from '../data';
import type { Choice, Figure, Picked } from '../model';
import { format_number } from '../numbers';
import {
  convert,
  describe_size,
  describe_value,
  end_title,
  get_curve_name,
  get_order,
  get_picked,
  get_problem,
  get_style,
  get_unit,
  make_problem_choices,
  make_ranked_chart,
  make_symbol,
  name_axis,
  type Scope,
} from './study_parts';

const kMostLabels = 10;

function draw_cost(look: Look, scope: Scope, problem: StudyProblem, target: number): EChartsOption {
  const unit = get_unit(problem.quantity);
  const order = get_order(scope, problem);
  const times = order.map((o) => problem.results[o].running_times[target]);
  const costs = times.map((time) => (time ? time.expected : null));
  const values = order.map((o) => convert(problem.results[o].median, unit));
  const x = make_scale(
    costs,
    true,
    costs.some((cost) => cost === null),
  );
  const y = make_scale(
    values,
    true,
    values.some((value) => value === null),
  );
  // Labels in a strip stand side by side.
  const places = order.map((_, i): [number, number] => {
    const share = [0.3, 0.5, 0.7][i % 3];
    return [place_on(x, costs[i], share), place_on(y, values[i], share)];
  });
  const points = order.map((o, i) => {
    const style = get_style(look, scope, o);
    const time = times[i];
    return {
      value: places[i],
      ...make_symbol(look, style),
      symbolSize: 10,
      note:
        scope.names[o] +
        '; median ' +
        describe_value(problem.results[o].median, unit) +
        '; ' +
        (time && time.expected !== null
          ? format_number(time.expected) +
            ' cases expected (' +
            format_number(time.interval[0], 3) +
            ' to ' +
            format_number(time.interval[1], 3) +
            '), reached by ' +
            time.reached +
            ' of ' +
            problem.results[o].cells.length
          : 'target not reached'),
    };
  });
  const labelled = order.map((_, i) => i).slice(0, kMostLabels);
  return make_ranked_chart(
    look,
    make_scaled_axis(look, 'x', 'expected running time to the target (simulated cases)', x, 'never'),
    make_scaled_axis(look, 'y', name_axis('median ' + problem.quantity.name, unit.unit), y, 'none'),
    [
      make_grid_lines(look, x, y),
      { type: 'scatter', name: 'optimizer', data: points, z: 3, clip: false },
      make_labels(
        look,
        labelled.map((i) => places[i]),
        labelled.map((i) => scope.names[order[i]]),
      ),
    ],
    [],
    [],
  );
}

// Returns a text such as "to 0.31 mm (1 % of the way left)".
function describe_target(problem: StudyProblem, target: number): string {
  const { unit } = get_curve_name(problem);
  const way = problem.start !== null && problem.best_known !== null ? problem.start - problem.best_known : 0;
  const share = way > 0 && problem.best_known !== null ? (target - problem.best_known) / way : NaN;
  return describe_value(target, unit) + (isFinite(share) ? ' (' + format_tenth(100 * share) + ' % of the way left)' : '');
}

function format_tenth(value: number): string {
  return String(Number(value.toPrecision(2)));
}

function count_reached(problem: StudyProblem, target: number): number {
  return problem.results.filter((one) => (one.running_times[target]?.reached ?? 0) > 0).length;
}

export function make_cost_quality(scope: Scope): Figure | null {
  const count = scope.problems.reduce((most, problem) => Math.max(most, problem.results[0]?.running_times.length ?? 0), 0);
  if (count === 0) {
    return null;
  }
  const one = scope.problems.length === 1 ? scope.problems[0] : null;
  const target: Choice = { id: 'target', label: 'Target', options: [], initial: '0' };
  for (let t = 0; t < count; ++t) {
    const example = scope.problems[0].results[0]?.running_times[t]?.target ?? 0;
    target.options.push({ value: String(t), label: one ? describe_target(one, example) : 'target ' + (t + 1) });
    // Chooses the tightest target that at least half of the optimizers reach.
    if (2 * count_reached(scope.problems[0], t) >= scope.names.length) {
      target.initial = String(t);
    }
  }
  const get_target = (picked: Picked) => Number(get_picked(target, picked));
  return {
    kind: 'figure',
    id: 'cost-quality' + scope.suffix,
    title: end_title(scope, 'Cost against quality'),
    caption:
      'Each point is an optimizer. One axis has the average number of simulated cases that it needs to reach the chosen target, with a new start after each run that fails. The other axis has the median value at the end of the budget. Points towards the lower left are better. ' +
      'An optimizer that reached the target in no run is in the strip at the right. ' +
      'Targets lie between the start and the best known value, and depend on the optimizers that take part. ' +
      'Neither axis shows how certain a difference is; the figure of the pairs does. ' +
      (scope.shown.length > kMostLabels ? 'The best ' + kMostLabels + ' are named. ' : '') +
      describe_size(scope),
    height: 400,
    choices: make_problem_choices(scope).concat([target]),
    draw: (look, picked) => draw_cost(look, scope, get_problem(scope, picked), get_target(picked)),
    table: (picked) => {
      const problem = get_problem(scope, picked);
      const unit = get_unit(problem.quantity);
      return {
        columns: [
          { label: 'optimizer' },
          { label: 'median', unit: unit.unit, numeric: true },
          { label: 'expected running time', unit: 'cases', numeric: true, digits: 6 },
          { label: 'lower', unit: 'cases', numeric: true, digits: 6 },
          { label: 'upper', unit: 'cases', numeric: true, digits: 6 },
          { label: 'runs that reached it', numeric: true, digits: 9 },
          { label: 'runs', numeric: true, digits: 9 },
        ],
        rows: get_order(scope, problem).map((o) => {
          const result = problem.results[o];
          const time = result.running_times[get_target(picked)];
          return [
            scope.names[o],
            convert(result.median, unit),
            time ? time.expected : null,
            time ? time.interval[0] : null,
            time ? time.interval[1] : null,
            time ? time.reached : null,
            result.cells.length,
          ];
        }),
      };
    },
  };
}
