// Axes with our own ends and ticks. ECharts labels a logarithmic axis only at powers of ten, so
// most of our axes would have one or two numbers. Values that do not exist also need a place,
// beyond the end of the axis.
import type { Look } from './look';
import { make_axis, type Part } from './parts';

export interface Scale {
  log: boolean;
  low: number; // ends of the range that is drawn to scale
  high: number;
  end: number; // end of the axis; the strip beyond `high` is the place of values that do not exist
  ticks: number[];
}

function make_linear_ticks(low: number, high: number): number[] {
  const rough = (high - low) / 5;
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map((one) => one * power).filter((one) => one >= rough * 0.999)[0] ?? 10 * power;
  const ticks: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step && ticks.length < 20; ++i) {
    ticks.push(Number((i * step).toPrecision(12)));
  }
  return ticks;
}

function make_log_ticks(low: number, high: number): number[] {
  const decades = Math.log10(high / low);
  const every = Math.ceil(decades / 7);
  const steps = decades > 3 ? [1] : decades > 1.6 ? [1, 3] : decades > 0.7 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 8];
  const ticks: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power) {
    if (power % every === 0) {
      steps.forEach((step) => ticks.push(Number((step * Math.pow(10, power)).toPrecision(12))));
    }
  }
  const inside = ticks.filter((tick) => tick >= low * 0.9999 && tick <= high * 1.0001);
  return inside.length >= 3 ? inside : make_linear_ticks(low, high);
}

// Returns the scale of the finite values. It is logarithmic if `log` is true and all values are
// positive. With `strip` it has a place for values that do not exist.
export function make_scale(values: (number | null)[], log: boolean, strip = false): Scale {
  const finite = values.filter((value) => value !== null && isFinite(value)) as number[];
  let low = Infinity;
  let high = -Infinity;
  finite.forEach((value) => {
    low = Math.min(low, value);
    high = Math.max(high, value);
  });
  if (finite.length === 0) {
    low = 1;
    high = 10;
  }
  const is_log = log && low > 0;
  if (is_log) {
    const margin = Math.max(Math.pow(high / low, 0.03), high / low < 1.5 ? 1.1 : 1);
    low /= margin;
    high *= margin;
    return { log: true, low, high, end: strip ? high * Math.pow(high / low, 0.13) : high, ticks: make_log_ticks(low, high) };
  }
  const extent = high > low ? high - low : Math.abs(high) > 0 ? Math.abs(high) : 1;
  low = low >= 0 && low - 0.5 * extent < 0 ? 0 : low - 0.04 * extent;
  high += 0.04 * extent;
  return { log: false, low, high, end: strip ? high + 0.13 * (high - low) : high, ticks: make_linear_ticks(low, high) };
}

// Returns the place where a value that does not exist is drawn, at `share` of the width of the
// strip.
export function get_strip_place(scale: Scale, share = 0.5): number {
  return scale.log ? scale.high * Math.pow(scale.end / scale.high, share) : scale.high + share * (scale.end - scale.high);
}

export function place_on(scale: Scale, value: number | null, share = 0.5): number {
  return value === null || !isFinite(value) ? get_strip_place(scale, share) : value;
}

// Formats ticks, which are short numbers: "20", "0.5", "1e6".
export function format_tick(value: number): string {
  if (value === 0) {
    return '0';
  }
  const magnitude = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
  if (magnitude >= 5 || magnitude < -4) {
    const digits = Number((value / Math.pow(10, magnitude)).toPrecision(3));
    return digits + 'e' + magnitude;
  }
  return String(Number(value.toPrecision(6)));
}

// Returns an axis for the scale. If the scale has a strip, `strip_name` is its label.
export function make_scaled_axis(look: Look, direction: 'x' | 'y', name: string, scale: Scale, strip_name = ''): Part {
  const strip = scale.end > scale.high && strip_name !== '' ? [get_strip_place(scale)] : [];
  const base = make_axis(look, direction, name, { log: scale.log });
  return {
    ...base,
    min: scale.low,
    max: scale.end,
    axisTick: { ...(base.axisTick as Part), customValues: scale.ticks },
    axisLabel: {
      ...(base.axisLabel as Part),
      customValues: scale.ticks.concat(strip),
      formatter: (value: number) =>
        strip.length > 0 && Math.abs(value - strip[0]) <= 1e-9 * Math.abs(strip[0]) ? strip_name : format_tick(value),
    },
    splitLine: { show: false },
  };
}

// Returns an axis with a name at each whole number; the first is at the top or at the left. Places
// between whole numbers can be used.
export function make_name_axis(look: Look, names: string[], width: number): Part {
  return {
    ...make_axis(look, 'y', '', {}),
    name: undefined,
    min: -0.5,
    max: Math.max(1, names.length) - 0.5,
    inverse: true,
    axisTick: { show: false },
    axisLabel: {
      color: look.text,
      fontFamily: look.font,
      fontSize: 11,
      customValues: names.map((_, i) => i),
      formatter: (value: number) => names[Math.round(value)] ?? '',
      width,
      overflow: 'truncate',
      hideOverlap: true,
    },
    splitLine: { show: false },
  };
}

export const kGridLines = 'grid-lines'; // id of the series of make_grid_lines()

// Returns the grid lines at the ticks and the shade of the strip, as a series that must come first.
export function make_grid_lines(look: Look, x: Scale | null, y: Scale | null): Part {
  const lines: Part[] = [];
  (x ? x.ticks : []).forEach((tick) => lines.push({ xAxis: tick }));
  (y ? y.ticks : []).forEach((tick) => lines.push({ yAxis: tick }));
  const areas: Part[][] = [];
  if (x && x.end > x.high) {
    areas.push([{ xAxis: x.high }, { xAxis: x.end }]);
  }
  if (y && y.end > y.high) {
    areas.push([{ yAxis: y.high }, { yAxis: y.end }]);
  }
  return {
    id: kGridLines,
    type: 'line',
    silent: true,
    data: [],
    markLine: {
      silent: true,
      symbol: 'none',
      animation: false,
      label: { show: false },
      lineStyle: { color: look.grid, type: 'solid', width: 1 },
      data: lines,
      z: 0,
    },
    markArea: { silent: true, itemStyle: { color: look.bad, opacity: 0.07 }, data: areas, z: 0 },
    z: 0,
  };
}

// Returns an estimate of the width of the drawn text. SVG is made without a screen on which text
// could be measured.
export function estimate_width(text: string, size: number): number {
  return 0.62 * size * text.length;
}
