// The parts of a figure beside its curves: limits, stretches of time, panels side by side.
import type { EChartsOption } from './echarts';
import { get_series_style, type Look, type SeriesStyle } from './look';
import { make_axis, make_chart, type AxisOptions, type Part } from './parts';
import { format_tick, make_scale } from './scales';

export interface NumberAxisOptions extends AxisOptions {
  values?: (number | null)[]; // the values that the axis shows; a logarithmic axis gets its ends and ticks from them
}

// Returns make_axis() with short numbers, and with enough of them if the axis is logarithmic.
export function make_number_axis(look: Look, direction: 'x' | 'y', name: string, options: NumberAxisOptions = {}, more: Part = {}): Part {
  const axis = make_axis(look, direction, name, options);
  const label = {
    ...(axis.axisLabel as Part),
    formatter: options.categories ? undefined : format_tick,
    // An end at the first value is not a round number, so it gets no label.
    showMinLabel: options.min === 'dataMin' ? false : undefined,
    showMaxLabel: options.max === 'dataMax' ? false : undefined,
  };
  if (!options.log || options.values === undefined) {
    return { ...axis, axisLabel: label, ...more };
  }
  const scale = make_scale(options.values, true);
  return {
    ...axis,
    min: scale.low,
    max: scale.high,
    axisTick: { ...(axis.axisTick as Part), customValues: scale.ticks },
    axisLabel: { ...label, customValues: scale.ticks },
    ...more,
  };
}

// Returns make_chart() with a legend that shows lines as they are drawn.
export function make_plot(look: Look, x: Part | Part[], y: Part | Part[], series: Part[], more: Part = {}): EChartsOption {
  const shown = series.map((one) => (one.type === 'line' && one.showSymbol === false ? { ...one, symbol: 'none' } : one));
  const option = make_chart(look, x, y, shown, more);
  const legend = option.legend as Part | undefined;
  if (legend === undefined) {
    return option;
  }
  const has_symbols = (name: string) => shown.some((one) => one.name === name && one.silent !== true && one.symbol !== 'none');
  const entries = (legend.data as string[]).map((name) => (has_symbols(name) ? { name } : { name, itemStyle: { opacity: 0 } }));
  // Without a screen the width of texts is only estimated, so the entries get some more space.
  return { ...option, legend: { itemGap: 20, itemWidth: 28, ...legend, data: entries } };
}

// Returns make_plot() for curves without symbols. The pointer shows all curves at its place, but no
// bands.
export function make_curve_plot(look: Look, x: Part | Part[], y: Part | Part[], series: Part[], more: Part = {}): EChartsOption {
  const shown = series.map((one) => (one.silent === true ? { ...one, tooltip: { show: false } } : one));
  return make_plot(look, x, y, shown, { tooltip: { trigger: 'axis', confine: true }, ...more });
}

const kDashes: SeriesStyle['dash'][] = ['solid', 'dashed', 'dotted', [8, 3, 2, 3], [12, 4]];

// Returns a style for curves that cross often and have no symbols: dashes distinguish them too.
export function get_line_style(look: Look, index: number): SeriesStyle {
  return { ...get_series_style(look, index), dash: kDashes[index % kDashes.length] };
}

// Returns a vertical line with a word beside it. Its height is the range of the axis of the curves.
export function make_vertical(look: Look, value: number, label: string, color = look.muted, axis = 0, at_foot = false): Part {
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
        position: at_foot ? 'insideStartTop' : 'insideEndTop',
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

// Returns shaded stretches of the abscissa, behind the curves.
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

// Returns the grids of panels in `columns` columns, in percent of the figure. `height` is the
// height of the figure in pixels, on which the space for axes depends.
export function make_panels(count: number, columns: number, height: number): Part[] {
  const rows = Math.ceil(count / columns);
  const head = (44 / height) * 100;
  const foot = (50 / height) * 100;
  const gap = (46 / height) * 100;
  const panel = (100 - head - foot - gap * (rows - 1)) / rows;
  const left = columns > 2 ? 8.5 : columns > 1 ? 10 : 11;
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

// Returns a heading in the corner of a panel.
export function make_panel_title(look: Look, grid: Part, text: string): Part {
  return {
    text,
    left: grid.left,
    top: grid.top,
    padding: [-15, 0, 0, 2],
    textStyle: { color: look.text, fontFamily: look.font, fontSize: 12, fontWeight: 'normal' },
  };
}
