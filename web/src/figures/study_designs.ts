// The designs of the winners on parallel axes. They show whether different optimizers end at the
// same place.
import type { EChartsOption } from '../charts/echarts';
import type { Look } from '../charts/look';
import { make_axis, make_chart, type Part } from '../charts/parts';
import { shorten } from '../charts/names';
import { format_tick } from '../charts/scales';
import type { StudyCell, StudyProblem } from '../data';
import type { Cell, Choice, Figure, Picked, Value } from '../model';
import { format_choice } from './quantities';
import { describe_cell } from './study_values';
import {
  describe_size,
  end_title,
  get_order,
  get_picked,
  get_problem,
  get_style,
  get_unit,
  kMostAtFirst,
  make_problem_choices,
  make_symbol,
  type Scope,
} from './study_parts';

type Variable = StudyProblem['variables'][0];

// For a logarithmic variable, the logarithm of the magnitude counts. Its bounds have one sign.
function place(variable: Variable, value: number): number {
  const on = (one: number) => (variable.logarithmic ? Math.log(Math.abs(one)) : one);
  const [low, high] = [on(variable.lower), on(variable.upper)];
  const share = high === low ? 0.5 : (on(value) - low) / (high - low);
  return isFinite(share) ? share : 0;
}

function get_best(cells: StudyCell[]): StudyCell | null {
  return cells
    .filter((cell) => cell.value !== null && cell.x.length > 0)
    .reduce((best: StudyCell | null, cell) => (best === null || (cell.value as number) < (best.value as number) ? cell : best), null);
}

interface Line {
  optimizer: number;
  cell: StudyCell;
}

function get_lines(scope: Scope, problem: StudyProblem, which: string): Line[] {
  return get_order(scope, problem).reduce((lines, optimizer) => {
    const cells = problem.results[optimizer].cells.filter((cell) => cell.x.length === problem.variables.length);
    const best = get_best(cells);
    const kept = which === 'best' ? (best ? [best] : []) : cells;
    return lines.concat(kept.map((cell) => ({ optimizer, cell })));
  }, [] as Line[]);
}

// Returns what the name of an axis says of its scale; the caption explains the words.
function describe_axis(variable: Variable): string {
  if (variable.type === 'real') {
    return variable.logarithmic ? '' : ' (linear)';
  }
  return variable.logarithmic ? ` (${variable.type}, logarithmic)` : ` (${variable.type})`;
}

// Explains the axes of the types that the problems have.
function explain_axes(scope: Scope): string {
  const has = (type: Variable['type']) => scope.problems.some((problem) => problem.variables.some((one) => one.type === type));
  return (
    (has('real')
      ? `Axes ${has('integer') || has('category') ? 'of real variables ' : ''}are logarithmic in the magnitude unless their name says linear. ` +
        'The sign is that of the numbers at their ends. '
      : '') +
    (has('integer') ? 'Axes of integers are linear unless their name says logarithmic. ' : '') +
    (has('category') ? 'An axis of a category has one place per word, in the order of the words; this order has no meaning. ' : '')
  );
}

type Drawing = { coord(point: number[]): number[]; getHeight(): number };

const kUpright_px = 24; // axes closer than this have no room for numbers beside each other
const kLevel_px = 120; // axes farther apart than this have room for their names beside each other

// Makes one vertical axis per variable, with its bounds, and with the start as a mark.
function make_axes(look: Look, variables: Variable[]): Part {
  return {
    type: 'custom',
    name: 'variable',
    data: variables.map((variable, i) => ({
      value: [i, 0, 1],
      note:
        shorten(variable.name) +
        (variable.unit === '' || variable.unit === '1' ? '' : ' (' + shorten(variable.unit, 12) + ')') +
        '; from ' +
        format_choice(variable.choices, variable.lower) +
        ' to ' +
        format_choice(variable.choices, variable.upper) +
        (variable.logarithmic ? ', logarithmic' : '') +
        '; start ' +
        format_choice(variable.choices, variable.start),
    })),
    encode: { x: 0, y: [1, 2] },
    clip: false,
    z: 4,
    renderItem: (item: { dataIndex: number; coordSys: { width: number } }, api: Drawing) => {
      const i = item.dataIndex;
      const variable = variables[i];
      const [x, bottom] = api.coord([i, 0]);
      const top = api.coord([i, 1])[1];
      const y_start = api.coord([i, Math.min(1, Math.max(0, place(variable, variable.start)))])[1];
      const room = item.coordSys.width / Math.max(1, variables.length);
      const crowded = room < 44;
      // Numbers that are wider than the distance of the axes stand upright, and names below them.
      const is_upright = room < kUpright_px;
      const is_level = room > kLevel_px;
      const number = (value: number, at_y: number, is_above: boolean): Part => ({
        type: 'text',
        x,
        y: at_y,
        rotation: is_upright ? Math.PI / 2 : 0,
        style: {
          text:
            variable.choices[value] === undefined
              ? format_tick(Number(value.toPrecision(crowded ? 2 : 3)))
              : shorten(variable.choices[value], 8),
          fill: look.muted,
          font: '10px ' + look.font,
          textAlign: is_upright ? (is_above ? 'left' : 'right') : 'center',
          textVerticalAlign: is_upright ? 'middle' : is_above ? 'bottom' : 'top',
        },
      });
      return {
        type: 'group',
        children: [
          { type: 'line', shape: { x1: x, y1: top, x2: x, y2: bottom }, style: { stroke: look.muted, lineWidth: 1 } },
          {
            type: 'polygon',
            shape: {
              points: [
                [x - 7, y_start - 4],
                [x - 7, y_start + 4],
                [x - 1, y_start],
              ],
            },
            style: { fill: look.muted },
          },
          number(variable.upper, top - 5, true),
          number(variable.lower, bottom + 5, false),
          {
            type: 'text',
            x,
            y: bottom + (is_upright ? 44 : 22),
            rotation: is_upright ? Math.PI / 2 : is_level ? 0 : Math.PI / 5,
            style: {
              text: shorten(variable.name, 22) + describe_axis(variable),
              fill: look.text,
              font: '10px ' + look.font,
              textAlign: is_level ? 'center' : 'right',
              textVerticalAlign: 'middle',
              width: is_upright ? Math.min(100, api.getHeight() - bottom - 46) : is_level ? room - 12 : 100,
              overflow: 'truncate',
            },
          },
        ],
      };
    },
  };
}

function draw_parallel(look: Look, scope: Scope, problem: StudyProblem, which: string, highlighted: string): EChartsOption {
  const lines = get_lines(scope, problem, which);
  const chosen = highlighted === '' ? -1 : Number(highlighted);
  const first_ones = get_order(scope, problem).slice(0, kMostAtFirst);
  const series: Part[] = [make_axes(look, problem.variables)];
  lines.forEach((line) => {
    const grey = chosen >= 0 ? line.optimizer !== chosen : false;
    const style = get_style(look, scope, line.optimizer);
    const note = describe_cell(scope, problem, line.optimizer, line.cell, get_unit(problem.quantity));
    const color = grey ? look.muted : style.color;
    series.push({
      type: 'line',
      name: scope.names[line.optimizer],
      data: line.cell.x.map((value, i) => ({
        value: [i, place(problem.variables[i], value)],
        note: note + '; ' + shorten(problem.variables[i].name) + ' = ' + format_choice(problem.variables[i].choices, value),
        command: line.cell.command,
      })),
      symbol: make_symbol(look, style).symbol,
      symbolSize: grey ? 2 : 5,
      showSymbol: true,
      showAllSymbol: true,
      color: style.color,
      itemStyle: grey ? { color, opacity: 0.3 } : { ...make_symbol(look, style).itemStyle, opacity: 0.9 },
      lineStyle: {
        color,
        type: style.dash,
        width: which === 'best' || chosen >= 0 ? 1.6 : 1,
        opacity: grey ? 0.18 : which === 'best' ? 0.9 : 0.5,
      },
      z: grey ? 2 : 3,
    });
  });
  const names = get_order(scope, problem).map((o) => scope.names[o]);
  const drawn = first_ones.concat(chosen >= 0 && first_ones.indexOf(chosen) < 0 ? [chosen] : []).map((o) => scope.names[o]);
  const selected: Record<string, boolean> = {};
  names.forEach((name) => (selected[name] = drawn.indexOf(name) >= 0));
  const x: Part = { type: 'value', show: false, min: -0.4, max: Math.max(1, problem.variables.length) - 0.6 };
  const y: Part = { ...make_axis(look, 'y', '', {}), show: false, min: 0, max: 1 };
  return make_chart(look, x, y, series, {
    grid: { left: 66, right: 16, top: names.length > 1 ? 62 : 30, bottom: 108, narrow: { left: 26, bottom: 150, head: 48 } },
    legend: {
      show: names.length > 1,
      type: 'scroll',
      top: 4,
      left: 8,
      right: 8,
      itemWidth: 24,
      itemGap: 16,
      data: names,
      selected,
      textStyle: { color: look.text, fontFamily: look.font, fontSize: 11, width: 130, overflow: 'truncate' },
      inactiveColor: look.muted,
      inactiveBorderColor: look.grid,
      pageTextStyle: { color: look.muted },
      pageIconColor: look.accent,
    },
  });
}

export function make_parallel(all: Scope): Figure | null {
  const scope: Scope = { ...all, problems: all.problems.filter((problem) => problem.variables.length > 0) };
  if (scope.problems.length === 0) {
    return null;
  }
  const which: Choice = {
    id: 'runs',
    label: 'Runs',
    options: [
      { value: 'best', label: "each optimizer's best" },
      { value: 'all', label: 'all replicates' },
    ],
    initial: 'best',
  };
  const highlight: Choice = {
    id: 'highlight',
    label: 'Highlight',
    options: [{ value: '', label: 'none' }].concat(scope.names.map((name, i) => ({ value: String(i), label: name }))),
    initial: '',
  };
  return {
    kind: 'figure',
    id: 'parallel' + scope.suffix,
    title: end_title(scope, "The winners' designs"),
    caption:
      'Each line is the winning design of a run. Each axis is a variable between its bounds, and the triangle marks the nominal start. ' +
      explain_axes(scope) +
      'Where the lines of good runs meet, the problem determines the variable. Where they spread, the variable hardly matters, or there are several solutions. ' +
      'Lines that end at a bound suggest that the bound is too tight. The figure shows interactions of neighbouring axes only. ' +
      'The best run of each optimizer was chosen by its value on the test set. ' +
      describe_size(scope),
    width: 'full',
    height: 440,
    choices: make_problem_choices(scope).concat([which, highlight]),
    draw: (look, picked: Picked) =>
      draw_parallel(look, scope, get_problem(scope, picked), get_picked(which, picked), get_picked(highlight, picked)),
    table: (picked) => {
      const problem = get_problem(scope, picked);
      const unit = get_unit(problem.quantity);
      return {
        columns: [
          { label: 'optimizer' } as { label: string; unit?: string; numeric?: boolean },
          { label: 'replicate', numeric: true },
          { label: problem.quantity.name, unit: unit.unit, numeric: true },
        ].concat(
          problem.variables.map((variable) => ({ label: variable.name, unit: variable.unit, numeric: variable.type !== 'category' })),
        ),
        rows: get_lines(scope, problem, get_picked(which, picked)).map((line): (Value | Cell)[] => {
          const value: Cell = { value: line.cell.value === null ? null : line.cell.value * unit.factor, command: line.cell.command };
          return [scope.names[line.optimizer], line.cell.replicate, value].concat(
            line.cell.x.map((x, i): Value => problem.variables[i]?.choices[x] ?? x) as never[],
          ) as (Value | Cell)[];
        }),
      };
    },
  };
}
