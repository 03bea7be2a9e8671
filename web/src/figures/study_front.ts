// Several objectives: the points that the runs found, and the area that half of the runs of an
// optimizer attain.
import type { EChartsOption } from '../charts/echarts';
import type { Look } from '../charts/look';
import { make_line, type Part, type Point } from '../charts/parts';
import { make_grid_lines, make_scale, make_scaled_axis } from '../charts/scales';
import type { StudyFront, StudyProblem } from '../data';
import type { Choice, Figure, Picked, Value } from '../model';
import { format_number } from '../numbers';
import {
  describe_size,
  end_title,
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

const kDrawnAtFirst = 4; // clouds of points hide each other sooner than curves do

function draw_front(look: Look, scope: Scope, problem: StudyProblem, front: StudyFront, first: number, second: number): EChartsOption {
  const units = front.objectives.map((objective) => get_unit(objective));
  const at = (values: number[]): [number, number] => [values[first] * units[first].factor, values[second] * units[second].factor];
  const all = front.optimizers.reduce(
    (points, one) => points.concat(one.points.map((point) => at(point.values))),
    [] as [number, number][],
  );
  const has_reference = front.reference_point.length > Math.max(first, second);
  const reference = has_reference ? at(front.reference_point) : null;
  const within = reference ? all.filter((point) => point[0] <= 1.5 * reference[0] && point[1] <= 1.5 * reference[1]) : all;
  const shown = (within.length > 0 ? within : all).concat(reference ? [reference] : []);
  const make_one = (k: number) => {
    const values = shown.map((point) => point[k]);
    const low = Math.min.apply(null, values.concat([Infinity]));
    return make_scale(values, low > 0 && Math.max.apply(null, values) > 30 * low);
  };
  const [x, y] = [make_one(0), make_one(1)];
  const series: Part[] = [make_grid_lines(look, x, y)];
  const order = get_order(scope, problem).filter((o) => front.optimizers[o] !== undefined);
  order.forEach((o) => {
    const style = get_style(look, scope, o);
    const name = scope.names[o];
    // Only two objectives have attained areas. The sides of an area reach to the ends of the axes.
    front.optimizers[o].attainment.forEach((surface) => {
      const corners = surface.points.map(at);
      if (corners.length === 0 || front.objectives.length !== 2) {
        return;
      }
      const [start, end] = [corners[0], corners[corners.length - 1]];
      const path: Point[] = [[start[0], y.high] as Point].concat(corners, [[Math.max(x.high, end[0]), end[1]]]);
      const line = make_line(look, 0, name, path, { style, step: 'end', width: surface.share === 0.5 ? 2.2 : 0.8 });
      series.push(first < second ? line : { ...line, step: 'start' });
    });
    series.push({
      type: 'scatter',
      name,
      data: front.optimizers[o].points.map((point) => ({
        value: at(point.values),
        note:
          name +
          ', replicate ' +
          point.replicate +
          '; ' +
          at(point.values)
            .map((value) => format_number(value))
            .join(', ') +
          (front.optimizers[o].igd_plus === null ? '' : '; median IGD+ ' + format_number(front.optimizers[o].igd_plus as number, 3)),
        command: problem.results[o].cells.filter((cell) => cell.replicate === point.replicate)[0]?.command,
      })),
      ...make_symbol(look, style),
      symbolSize: 5,
      color: style.color,
      z: 3,
      clip: true,
    });
  });
  if (reference) {
    series.push({
      type: 'scatter',
      name: 'reference point',
      data: [{ value: reference, note: 'reference point of the hypervolume' }],
      symbol: 'path://M-5,-1L-1,-1L-1,-5L1,-5L1,-1L5,-1L5,1L1,1L1,5L-1,5L-1,1L-5,1Z',
      symbolSize: 11,
      itemStyle: { color: look.bad },
      label: { show: true, formatter: 'reference', position: 'left', color: look.bad, fontSize: 11, fontFamily: look.font },
      z: 5,
    });
  }
  const names = order.map((o) => scope.names[o]);
  return make_ranked_chart(
    look,
    make_scaled_axis(look, 'x', name_axis(front.objectives[first].name, units[first].unit), x),
    make_scaled_axis(look, 'y', name_axis(front.objectives[second].name, units[second].unit), y),
    series,
    names,
    names.slice(0, kDrawnAtFirst),
  );
}

// Makes the figure of the problems of the scope that have fronts. Returns null if none has.
export function make_front(all: Scope): Figure | null {
  const scope: Scope = {
    ...all,
    problems: all.problems.filter((problem) => problem.front !== null && problem.front.objectives.length > 1),
  };
  if (scope.problems.length === 0) {
    return null;
  }
  const objectives = scope.problems.reduce((most, problem) => Math.max(most, problem.front?.objectives.length ?? 0), 0);
  const plane: Choice = { id: 'plane', label: 'Objectives', options: [], initial: '0-1' };
  const names = scope.problems[0].front?.objectives ?? [];
  for (let i = 0; i < objectives; ++i) {
    for (let k = i + 1; k < objectives; ++k) {
      const label = (n: number) => (scope.problems.length === 1 && names[n] ? name_axis(names[n].name, '') : 'objective ' + (n + 1));
      plane.options.push({ value: i + '-' + k, label: label(i) + ', ' + label(k) });
    }
  }
  const get_plane = (front: StudyFront, picked: Picked): [number, number] => {
    const [first, second] = get_picked(plane, picked).split('-').map(Number);
    return second < front.objectives.length ? [first, second] : [0, 1];
  };
  return {
    kind: 'figure',
    id: 'front' + scope.suffix,
    title: end_title(scope, 'Fronts of the objectives'),
    caption:
      'The points are the fronts of all replicates. Points towards the lower left are better. ' +
      (objectives === 2
        ? 'The thick stepped line bounds the area that half of the replicates of an optimizer attain. It is a typical front, whereas the points mix lucky and unlucky runs. Thin lines are for other shares of the replicates. '
        : 'With more than two objectives the plane shows a projection: a point that looks dominated may not be dominated. ') +
      'The cross is the reference point of the hypervolume, a tenth beyond the front of all runs together. Points far beyond it are not shown. A point also tells the median IGD+ of its optimizer, from the front of all runs together. ' +
      (scope.shown.length > kDrawnAtFirst ? 'The best ' + kDrawnAtFirst + ' optimizers are drawn at first. ' : '') +
      describe_size(scope),
    height: 420,
    width: 'full',
    choices: make_problem_choices(scope).concat(plane.options.length > 1 ? [plane] : []),
    draw: (look, picked) => {
      const problem = get_problem(scope, picked);
      const front = problem.front as StudyFront;
      const [first, second] = get_plane(front, picked);
      return draw_front(look, scope, problem, front, first, second);
    },
    table: (picked) => {
      const problem = get_problem(scope, picked);
      const front = problem.front as StudyFront;
      const units = front.objectives.map((objective) => get_unit(objective));
      const rows: Value[][] = [];
      const add = (o: number, what: string, values: number[]) =>
        rows.push([scope.names[o], what as Value].concat(units.map((unit, k) => (values[k] ?? NaN) * unit.factor)));
      get_order(scope, problem).forEach((o) => {
        const one = front.optimizers[o];
        (one ? one.points : []).forEach((point) => add(o, 'replicate ' + point.replicate, point.values));
        (one ? one.attainment : []).forEach((surface) =>
          surface.points.forEach((point) => add(o, 'attained by a share of ' + format_number(surface.share, 2), point)),
        );
      });
      return {
        columns: [{ label: 'optimizer' }, { label: 'what' } as { label: string; unit?: string; numeric?: boolean }].concat(
          front.objectives.map((objective, k) => ({ label: objective.name, unit: units[k].unit, numeric: true })),
        ),
        rows,
      };
    },
  };
}
