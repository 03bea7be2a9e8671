// The common parts of the figures of a comparison: names, units, colours, and the legend at the
// side.
import type { EChartsOption } from '../charts/echarts';
import { get_series_style, type Look, type SeriesStyle } from '../charts/look';
import { shorten, shorten_all } from '../charts/names';
import { make_chart, type Part } from '../charts/parts';
import { estimate_width } from '../charts/scales';
import type { Quantity, StudyData, StudyProblem } from '../data';
import type { Choice, Picked } from '../model';
import { format_number, kMillimetres } from '../numbers';

// The number of optimizers that are drawn at first. More curves would hide each other.
export const kMostAtFirst = 12;
// With more optimizers colours repeat, with other dashes and symbols.
const kColours = 8;

export interface Unit {
  factor: number;
  unit: string; // "" if it has no unit
}

export function get_unit({ unit, own_unit }: Quantity): Unit {
  return unit === 'm' && !own_unit ? { factor: kMillimetres, unit: 'mm' } : { factor: 1, unit: unit === '1' ? '' : shorten(unit, 12) };
}

export function convert(value: number | null | undefined, unit: Unit): number | null {
  return value === null || value === undefined || !isFinite(value) ? null : value * unit.factor;
}

export function convert_all(values: (number | null)[], unit: Unit): (number | null)[] {
  return values.map((value) => convert(value, unit));
}

export function name_axis(name: string, unit: string): string {
  return unit === '' ? shorten(name) : shorten(name) + ' (' + unit + ')';
}

// Returns the quantity of curves, targets and running times. With several objectives it differs
// from that of the values.
export function get_curve_name(problem: StudyProblem): { name: string; unit: Unit } {
  return problem.has_front
    ? { name: 'weighted sum of the objectives', unit: { factor: 1, unit: '' } }
    : { name: problem.quantity.name, unit: get_unit(problem.quantity) };
}

export function describe_value(value: number | null, unit: Unit, quantity?: Quantity): string {
  const text = value === null ? 'no value' : format_number(value * unit.factor) + (unit.unit === '' ? '' : ' ' + unit.unit);
  return quantity ? shorten(quantity.name) + ' ' + text : text;
}

// The problems of a figure or table: one problem, or several to choose from.
export interface Scope {
  data: StudyData;
  problems: StudyProblem[];
  suffix: string; // suffix of the ids
  names: string[]; // names of the optimizers, as drawn
  shown: number[]; // the optimizers of figures and tables; ranks and tests are always those of all
  styles: number[]; // one per optimizer, for get_series_style
}

// Returns the mean ranks over the problems or, if there are none, the places on the first problem.
export function get_ranks(data: StudyData): number[] {
  const order = data.problems[0]?.order ?? [];
  const count = data.optimizers.length;
  return data.overall ? data.overall.mean_ranks : data.optimizers.map((_, i) => (order.indexOf(i) < 0 ? count : order.indexOf(i)));
}

export function make_scope(data: StudyData, problems: StudyProblem[], suffix: string, shown?: number[]): Scope {
  const names = shorten_all(data.optimizers.map((one) => one.label));
  const styles = names.map((_, i) => i);
  const ranks = get_ranks(data);
  if (names.length > kColours && ranks.length === names.length) {
    // The best optimizers get the colours that are easiest to distinguish.
    sort_by(styles, (i) => ranks[i]).forEach((optimizer, place) => (styles[optimizer] = place));
  }
  return { data, problems, suffix, names, shown: shown ?? names.map((_, i) => i), styles };
}

// Returns a sorted copy. Equal items keep their order.
export function sort_by<T>(items: T[], key: (item: T) => number): T[] {
  const keyed = items.map((item, i) => ({ item, i, key: key(item) }));
  keyed.sort((a, b) => (a.key < b.key ? -1 : a.key > b.key ? 1 : a.i - b.i));
  return keyed.map((one) => one.item);
}

// Returns the shown optimizers, best first. Those that the data do not rank come at the end.
export function get_order(scope: Scope, problem: StudyProblem): number[] {
  const all = scope.shown.filter((i) => problem.results[i] !== undefined);
  const ordered = problem.order.filter((i) => all.indexOf(i) >= 0);
  return ordered.concat(all.filter((i) => ordered.indexOf(i) < 0));
}

export function get_style(look: Look, scope: Scope, optimizer: number): SeriesStyle {
  return get_series_style(look, scope.styles[optimizer]);
}

// ECharts fills its empty symbols with white, also on a dark page. Here they get the background of
// the page.
export function make_symbol(look: Look, style: SeriesStyle): { symbol: string; itemStyle: Part } {
  if (style.symbol.indexOf('empty') !== 0) {
    return { symbol: style.symbol, itemStyle: { color: style.color } };
  }
  return {
    symbol: style.symbol.slice('empty'.length).toLowerCase(),
    itemStyle: { color: look.background, borderColor: style.color, borderWidth: 1.6 },
  };
}

const kProblemChoice = 'problem';

export function make_problem_choices(scope: Scope): Choice[] {
  if (scope.problems.length < 2) {
    return [];
  }
  const labels = shorten_all(scope.problems.map((problem) => problem.label));
  return [{ id: kProblemChoice, label: 'Problem', options: labels.map((label, i) => ({ value: String(i), label })), initial: '0' }];
}

export function get_problem(scope: Scope, picked: Picked): StudyProblem {
  return scope.problems[Number(picked[kProblemChoice] ?? '0')] ?? scope.problems[0];
}

export function get_picked(choice: Choice, picked: Picked): string {
  const value = picked[choice.id];
  return choice.options.filter((option) => option.value === value).length > 0 ? value : choice.initial;
}

// Returns "15 replicates" and the number of missing cells.
export function describe_size(scope: Scope): string {
  const n = scope.data.replicates;
  const missing = scope.problems.reduce((sum, problem) => sum + problem.missing, 0);
  const size =
    n === 1 ? 'There is one replicate per optimizer, so its value decides nothing.' : 'There are ' + n + ' replicates per optimizer.';
  return missing === 0
    ? size
    : size +
        ' Unfinished: ' +
        missing +
        (missing === 1 ? ' run has' : ' runs have') +
        ' not ended. The numbers are those of the runs that have ended, so optimizers may be compared on different replicates.';
}

export function end_title(scope: Scope, title: string): string {
  return scope.problems.length === 1 && scope.data.problems.length > 1 ? title + ': ' + shorten(scope.problems[0].label) : title;
}

// Makes a chart with its legend at the right, best first. The series in `drawn` are switched on at
// first.
export function make_ranked_chart(
  look: Look,
  x: Part,
  y: Part,
  series: Part[],
  legend: string[],
  drawn: string[],
  more: Part = {},
): EChartsOption {
  const longest = legend.reduce((most, name) => Math.max(most, estimate_width(name, 11)), 0);
  const width = Math.min(150, Math.max(40, Math.ceil(longest)));
  const selected: Record<string, boolean> = {};
  legend.forEach((name) => (selected[name] = drawn.indexOf(name) >= 0));
  const has_legend = legend.length > 1;
  return make_chart(look, x, y, series, {
    grid: { left: 68, right: has_legend ? width + 66 : 24, top: 20, bottom: 48 },
    legend: has_legend
      ? {
          type: 'scroll',
          orient: 'vertical',
          right: 6,
          top: 14,
          bottom: 14,
          itemWidth: 26,
          itemHeight: 9,
          itemGap: 7,
          data: legend,
          selected,
          textStyle: { color: look.text, fontFamily: look.font, fontSize: 11, width, overflow: 'truncate' },
          inactiveColor: look.muted,
          inactiveBorderColor: look.grid,
          pageTextStyle: { color: look.muted },
          pageIconColor: look.accent,
          pageIconInactiveColor: look.grid,
        }
      : { show: false },
    ...more,
  });
}

// Returns the stretches of consecutive rows that are not null.
export function split_rows<T>(rows: (T | null)[]): T[][] {
  const pieces: T[][] = [[]];
  rows.forEach((row) => {
    if (row === null) {
      pieces.push([]);
    } else {
      pieces[pieces.length - 1].push(row);
    }
  });
  return pieces.filter((piece) => piece.length > 0);
}
