// Zooming into the abscissa of curves, and their values at one place of it. Both work on the drawn
// options, so every figure of curves has them.
import type { EChartsOption } from './echarts';
import type { Part } from './parts';
import { format_tick, kGridLines, make_grid_lines, make_scale, type Scale } from './scales';
import type { Look } from './look';

export interface Range {
  from: number;
  to: number;
}

export type Selected = Record<string, boolean>; // false for the series that the legend has switched off

// The value of a curve at a place of the abscissa.
export interface Reading {
  name: string;
  color: string;
  value: number;
}

function to_list(part: unknown): Part[] {
  return part === undefined ? [] : Array.isArray(part) ? (part as Part[]) : [part as Part];
}

type Pair = [number, number | null];

function get_pairs(series: Part): Pair[] {
  const data = (series.data as unknown[] | undefined) ?? [];
  return data.map((one) => (Array.isArray(one) ? one : (one as { value: unknown[] }).value) as Pair);
}

function is_curve(series: Part): boolean {
  return series.type === 'line' && series.silent !== true && series.name !== undefined;
}

function find_axis(series: Part): number {
  return (series.xAxisIndex as number | undefined) ?? 0;
}

// Returns whether the abscissa of all curves is a number that grows along them.
export function can_zoom(option: EChartsOption): boolean {
  const axes = to_list(option.xAxis);
  const curves = to_list(option.series).filter(is_curve);
  return (
    axes.every((axis) => axis.type === 'value' || axis.type === 'log') &&
    curves.some((one) => get_pairs(one).length > 2) &&
    curves.every((one) => get_pairs(one).every((pair, i, all) => i === 0 || pair[0] >= all[i - 1][0]))
  );
}

// Returns the value of a curve at `x`: between two points a straight line, as it is drawn. Returns
// null where the curve has no points.
function read_at(pairs: Pair[], x: number, log: boolean, step: unknown): number | null {
  let low = 0;
  let high = pairs.length - 1;
  if (high < 0 || !(x >= pairs[0][0] && x <= pairs[high][0])) {
    return null;
  }
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (pairs[middle][0] <= x) {
      low = middle;
    } else {
      high = middle;
    }
  }
  const [a, b] = [pairs[low][1], pairs[high][1]];
  if (x === pairs[high][0]) {
    return b;
  }
  if (x === pairs[low][0] || step === 'end') {
    return a;
  }
  if (a === null || b === null || step === 'start') {
    return b;
  }
  const share = (x - pairs[low][0]) / (pairs[high][0] - pairs[low][0]);
  return log && a > 0 && b > 0 ? a * Math.pow(b / a, share) : a + share * (b - a);
}

// Returns the values of the curves of a panel at `x`, in the order of the legend.
export function read_curves(option: EChartsOption, axis: number, x: number, selected: Selected = {}): Reading[] {
  const log = to_list(option.yAxis)[axis]?.type === 'log';
  const readings: Reading[] = [];
  to_list(option.series)
    .filter((one) => is_curve(one) && find_axis(one) === axis && selected[one.name as string] !== false)
    .forEach((one) => {
      const value = read_at(get_pairs(one), x, log, one.step);
      if (value !== null && isFinite(value)) {
        readings.push({ name: one.name as string, color: one.color as string, value });
      }
    });
  return readings;
}

// Returns the values within the range, and those of the curves at its ends. A straight line through
// two points, such as a limit, does not count, because it may be far from the curves.
function list_values(option: EChartsOption, axis: number, range: Range, selected: Selected): number[] {
  const series = to_list(option.series).filter(
    (one) =>
      find_axis(one) === axis &&
      one.silent !== true &&
      one.name !== undefined &&
      selected[one.name as string] !== false &&
      (one.type !== 'line' || get_pairs(one).length > 2),
  );
  const values = read_curves({ ...option, series }, axis, range.from)
    .concat(read_curves({ ...option, series }, axis, range.to))
    .map((one) => one.value);
  series.forEach((one) =>
    get_pairs(one).forEach(([x, y]) => {
      if (x >= range.from && x <= range.to && y !== null && isFinite(y)) {
        values.push(y);
      }
    }),
  );
  return values;
}

function get_ticks(axis: Part): number[] | undefined {
  return (axis.axisTick as Part | undefined)?.customValues as number[] | undefined;
}

function rescale(axis: Part, low: number, high: number, ticks: number[] | undefined): Part {
  return {
    ...axis,
    min: low,
    max: high,
    axisTick: { ...(axis.axisTick as Part), customValues: ticks },
    axisLabel: { ...(axis.axisLabel as Part), customValues: ticks, formatter: format_tick, showMinLabel: true, showMaxLabel: true },
  };
}

// A strip for values that do not exist has a label beside those of the ticks.
function has_strip(axis: Part): boolean {
  const labels = (axis.axisLabel as Part | undefined)?.customValues as number[] | undefined;
  return labels !== undefined && labels.length > (get_ticks(axis) ?? []).length;
}

// Returns the option with the abscissae of `ranges` and with the ordinates that the curves need
// there. The panel with index i has ranges[i]; null leaves it as it is.
export function zoom_in(look: Look, option: EChartsOption, ranges: (Range | null)[], selected: Selected = {}): EChartsOption {
  const x_axes = to_list(option.xAxis).slice();
  const y_axes = to_list(option.yAxis).slice();
  let series = to_list(option.series);
  ranges.forEach((range, i) => {
    if (range === null || x_axes[i] === undefined) {
      return;
    }
    const x = make_scale([range.from, range.to], x_axes[i].type === 'log');
    const inside = x.ticks.filter((tick) => tick >= range.from && tick <= range.to);
    x_axes[i] = rescale(x_axes[i], range.from, range.to, inside);
    let y: Scale | null = null;
    const values = list_values(option, i, range, selected);
    if (y_axes[i] !== undefined && values.length > 0 && !has_strip(y_axes[i])) {
      y = make_scale(values, y_axes[i].type === 'log');
      y_axes[i] = rescale(y_axes[i], y.low, y.high, y.ticks);
    }
    if (y !== null) {
      const lines = make_grid_lines(look, { ...x, high: range.to, end: range.to, ticks: inside }, y);
      series = series.map((one) => (one.id === kGridLines ? lines : one)); // only charts of one panel have them
    }
  });
  const as_before = (before: unknown, parts: Part[]) => (Array.isArray(before) ? parts : parts[0]);
  return { ...option, xAxis: as_before(option.xAxis, x_axes), yAxis: as_before(option.yAxis, y_axes), series };
}
