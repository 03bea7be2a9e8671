// What stands in a figure beside its curves: limits, stretches of time, panels side by side.
import { format_number } from '../numbers';
import type { EChartsOption } from './echarts';
import { get_series_style, type Look, type SeriesStyle } from './look';
import { make_axis, make_chart, type AxisOptions, type Part } from './parts';

// Numbers at an axis: "0.001", "1e-5", "20000"; no zeros at the end.
export function format_tick(value: number): string {
  if (value === 0) {
    return '0';
  }
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) {
    return value.toExponential(2).replace(/\.?0+e/, 'e').replace('e+', 'e');
  }
  return String(parseFloat(value.toPrecision(6)));
}

// make_axis() with short numbers.
export function make_number_axis(look: Look, direction: 'x' | 'y', name: string, options: AxisOptions = {}, more: Part = {}): Part {
  const axis = make_axis(look, direction, name, options);
  return {
    ...axis,
    axisLabel: { ...(axis.axisLabel as Part), formatter: options.categories ? undefined : format_tick },
    ...more,
  };
}

// make_chart() with readable numbers where the pointer is.
export function make_plot(look: Look, x: Part | Part[], y: Part | Part[], series: Part[], more: Part = {}): EChartsOption {
  return make_chart(look, x, y, series, {
    tooltip: { trigger: 'item', valueFormatter: format_value, confine: true },
    ...more,
  });
}

function format_value(value: unknown): string {
  if (typeof value === 'number') {
    return format_number(value);
  }
  return Array.isArray(value) ? value.map(format_value).join(', ') : String(value ?? '–');
}

const kDashes: SeriesStyle['dash'][] = ['solid', 'dashed', 'dotted', [8, 3, 2, 3], [12, 4]];

// For curves that cross often and have no symbols: dashes tell them apart as well.
export function get_line_style(look: Look, index: number): SeriesStyle {
  return { ...get_series_style(look, index), dash: kDashes[index % kDashes.length] };
}

// A vertical line with a word beside it, in the range of the axis that the curves make.
export function make_vertical(look: Look, value: number, label: string, color = look.muted, axis = 0): Part {
  return {
    type: 'line',
    data: [],
    silent: true,
    xAxisIndex: axis,
    yAxisIndex: axis,
    markLine: {
      silent: true,
      symbol: 'none',
      animation: false,
      lineStyle: { color, type: 'dashed', width: 1.2 },
      label: {
        formatter: () => label,
        position: 'insideEndTop',
        color: look.text,
        fontFamily: look.font,
        fontSize: 11,
        textBorderColor: look.background,
        textBorderWidth: 2,
      },
      data: [{ xAxis: value }],
    },
  };
}

// Stretches of the abscissa behind the curves.
export function make_stretches(look: Look, stretches: [number, number][], color: string, axis = 0, opacity = 0.1, label = ''): Part {
  return {
    type: 'line',
    data: [],
    silent: true,
    xAxisIndex: axis,
    yAxisIndex: axis,
    markArea: {
      silent: true,
      animation: false,
      itemStyle: { color, opacity },
      label: {
        show: label !== '',
        formatter: () => label,
        position: 'insideTop',
        color: look.muted,
        fontFamily: look.font,
        fontSize: 11,
      },
      data: stretches.map(([from, to]) => [{ xAxis: from }, { xAxis: to }]),
    },
  };
}

// Grids of panels in so many columns, in percent of the figure. `height` is the figure's, in pixels,
// on which the space for axes depends.
export function make_panels(count: number, columns: number, height: number): Part[] {
  const rows = Math.ceil(count / columns);
  const head = (44 / height) * 100;
  const foot = (50 / height) * 100;
  const gap = (46 / height) * 100;
  const panel = (100 - head - foot - gap * (rows - 1)) / rows;
  const left = columns > 2 ? 7.5 : columns > 1 ? 10 : 11;
  const width = (100 - 2) / columns - left;
  const grids: Part[] = [];
  for (let i = 0; i < count; ++i) {
    grids.push({
      left: `${left + (i % columns) * (left + width)}%`,
      width: `${width}%`,
      top: `${head + Math.floor(i / columns) * (panel + gap)}%`,
      height: `${panel}%`,
    });
  }
  return grids;
}

// A heading in the panel's corner.
export function make_panel_title(look: Look, grid: Part, text: string): Part {
  return {
    text,
    left: grid.left,
    top: grid.top,
    padding: [-15, 0, 0, 2],
    textStyle: { color: look.text, fontFamily: look.font, fontSize: 12, fontWeight: 'normal' },
  };
}
