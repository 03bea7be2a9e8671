// The parts of which figures are made, so that all figures look alike.
import type { Provenance, Value } from '../model';
import type { EChartsOption } from './echarts';
import { get_series_style, type Look, type SeriesStyle } from './look';

// The option types of ECharts fill a megabyte and accept any object, so this type replaces them.
export type Part = Record<string, unknown>;

export interface AxisOptions {
  log?: boolean;
  min?: number | 'dataMin';
  max?: number | 'dataMax';
  categories?: string[];
  inverse?: boolean;
  index?: number; // index of the grid
}

// Returns an axis with its name in the middle, such as "error (mm)".
export function make_axis(look: Look, direction: 'x' | 'y', name: string, options: AxisOptions = {}): Part {
  return {
    type: options.categories ? 'category' : options.log ? 'log' : 'value',
    data: options.categories,
    name,
    nameLocation: 'middle',
    nameGap: direction === 'x' ? 28 : 48,
    nameTextStyle: { color: look.muted, fontFamily: look.font, fontSize: 12 },
    axisLabel: { color: look.muted, fontFamily: look.font, fontSize: 11, hideOverlap: true },
    axisLine: { show: true, onZero: false, lineStyle: { color: look.muted } },
    axisTick: { show: true, lineStyle: { color: look.muted } },
    splitLine: { show: !options.categories, lineStyle: { color: look.grid } },
    min: options.min,
    max: options.max,
    scale: true,
    inverse: options.inverse,
    gridIndex: options.index,
  };
}

// Returns the options that every figure on Cartesian axes has beside its series. Legend entries
// switch series on and off.
export function make_chart(look: Look, x: Part | Part[], y: Part | Part[], series: Part[], more: Part = {}): EChartsOption {
  const names = series.filter((one) => one.name !== undefined && one.silent !== true).map((one) => one.name as string);
  const legend_names = names.filter((name, i) => names.indexOf(name) === i);
  return {
    animation: false,
    backgroundColor: look.background,
    textStyle: { fontFamily: look.font, color: look.text },
    color: look.series,
    grid: { left: 68, right: 24, top: legend_names.length > 1 ? 44 : 20, bottom: 48 },
    legend:
      legend_names.length > 1
        ? {
            type: 'scroll',
            top: 4,
            data: legend_names,
            textStyle: { color: look.text, fontFamily: look.font, fontSize: 12 },
            inactiveColor: look.muted,
            pageTextStyle: { color: look.muted },
            pageIconColor: look.accent,
          }
        : undefined,
    tooltip: { trigger: 'item' },
    xAxis: x,
    yAxis: y,
    series,
    ...more,
  };
}

export interface LineOptions {
  style?: SeriesStyle;
  symbols?: boolean;
  step?: 'start' | 'end';
  width?: number;
  axis?: number; // index of both axes
  on_top?: boolean; // over the other curves
}

// A point with its provenance, if that is known.
export type Point = [Value, Value] | ({ value: [Value, Value] } & Provenance);

export function make_line(look: Look, index: number, name: string, points: Point[], options: LineOptions = {}): Part {
  const style = options.style ?? get_series_style(look, index);
  return {
    type: 'line',
    name,
    data: points,
    showSymbol: options.symbols ?? false,
    symbol: style.symbol,
    symbolSize: 6,
    step: options.step,
    connectNulls: false,
    color: style.color,
    lineStyle: { color: style.color, type: style.dash, width: options.width ?? 1.8 },
    itemStyle: { color: style.color },
    emphasis: { focus: 'none' },
    z: options.on_top ? 4 : 3,
    xAxisIndex: options.axis ?? 0,
    yAxisIndex: options.axis ?? 0,
  };
}

type Coordinates = { value(dimension: number): number; coord(point: number[]): number[] };

// Returns the area between two curves, from rows of [x, low, high]. It belongs to the series `name`
// and disappears when that series is switched off.
export function make_band(name: string, rows: [number, number, number][], color: string, axis = 0): Part {
  const clean = rows.filter((row) => row.every((number) => isFinite(number)));
  return {
    type: 'custom',
    name,
    data: clean.length > 0 ? [[clean[0][0], clean[0][1], clean[0][2]]] : [],
    encode: { x: 0, y: [1, 2] },
    z: 1,
    silent: true,
    xAxisIndex: axis,
    yAxisIndex: axis,
    renderItem: (_: unknown, api: Coordinates) => ({
      type: 'polygon',
      shape: {
        points: clean
          .map((row) => api.coord([row[0], row[2]]))
          .concat(
            clean
              .slice()
              .reverse()
              .map((row) => api.coord([row[0], row[1]])),
          ),
      },
      style: { fill: color, opacity: 0.18 },
    }),
    clip: true,
  };
}

// Returns vertical bars with caps, from rows of [x, low, high].
export function make_error_bars(name: string, rows: [number, number, number][], color: string, axis = 0): Part {
  return {
    type: 'custom',
    name,
    data: rows.filter((row) => row.every((number) => isFinite(number))),
    encode: { x: 0, y: [1, 2] },
    z: 2,
    silent: true,
    xAxisIndex: axis,
    yAxisIndex: axis,
    renderItem: (_: unknown, api: Coordinates) => {
      const low = api.coord([api.value(0), api.value(1)]);
      const high = api.coord([api.value(0), api.value(2)]);
      const line = (x1: number, y1: number, x2: number, y2: number) => ({
        type: 'line',
        shape: { x1, y1, x2, y2 },
        style: { stroke: color, lineWidth: 1 },
      });
      return {
        type: 'group',
        children: [
          line(low[0], low[1], high[0], high[1]),
          line(low[0] - 3, low[1], low[0] + 3, low[1]),
          line(high[0] - 3, high[1], high[0] + 3, high[1]),
        ],
      };
    },
    clip: true,
  };
}

// Returns thick horizontal lines in rows of categories, from rows of [row, low, high].
export function make_spans(name: string, rows: [number, number, number][], color: string): Part {
  return {
    type: 'custom',
    name,
    data: rows.filter((row) => row.every((number) => isFinite(number))),
    encode: { x: [1, 2], y: 0 },
    z: 2,
    silent: true,
    itemStyle: { color },
    renderItem: (_: unknown, api: Coordinates) => {
      const low = api.coord([api.value(1), api.value(0)]);
      const high = api.coord([api.value(2), api.value(0)]);
      return {
        type: 'line',
        shape: { x1: low[0], y1: low[1], x2: high[0], y2: high[1] },
        style: { stroke: color, lineWidth: 5, opacity: 0.45 },
      };
    },
    clip: true,
  };
}
