// Charts on a narrow screen. A legend beside the curves goes above them, a legend with pages becomes
// rows, and panels stand one below the other. The chart grows by what this needs, so the curves keep
// their height.
import type { EChartsOption } from './echarts';
import type { Part } from './parts';
import { estimate_width } from './scales';

export const kNarrow_px = 480; // below this width a legend leaves no room beside itself

export interface FittedChart {
  option: EChartsOption;
  height_px: number;
}

const kEdge_px = 8; // between the legend and both edges of the chart
const kGap_px = 8; // between the entries of the legend, and between its rows
const kSymbol_px = 26;
const kLine_px = 14;
const kMostMargin = 0.76; // of the width, beside the curves
const kMostRows = 6; // a longer legend keeps its pages
const kHead_px = 24; // between the legend and the first panel: the heading of the panel, or numbers
const kBelow_px = 46; // between two panels: the numbers of the axis, and the heading of the next panel
const kLeft_px = 68; // for the name of the axis, a line that is up to 54 px away, and the numbers
const kRight_px = 12;

function get_name(entry: unknown): string {
  return typeof entry === 'string' ? entry : String((entry as Part).name);
}

interface Row {
  first: number; // entry
  height_px: number;
}

// Returns the rows into which the entries break. Entries of fixed width, which break into lines of
// `text_px`, have a row each.
function find_rows(names: string[], room_px: number, text_px: number, is_fixed: boolean): Row[] {
  const rows: Row[] = [];
  let used = Infinity;
  names.forEach((name, i) => {
    const text = estimate_width(name, 11);
    const width = kSymbol_px + 5 + (is_fixed ? text_px : text);
    if (used + width > room_px) {
      rows.push({ first: i, height_px: 0 });
      used = 0;
    }
    used += width + kGap_px;
    const row = rows[rows.length - 1];
    row.height_px = Math.max(row.height_px, Math.ceil(text / text_px) * kLine_px);
  });
  return rows;
}

function fit_legend(legend: Part, width_px: number): { legend: Part; height_px: number } {
  const room_px = width_px - 2 * kEdge_px;
  const text_px = room_px - kSymbol_px - 5;
  const names = (legend.data as unknown[]).map(get_name);
  const is_fixed = names.some((name) => estimate_width(name, 11) > text_px);
  const rows = find_rows(names, room_px, text_px, is_fixed);
  const is_paged = rows.length > kMostRows;
  // The chart breaks its rows where these end, so that it needs the height that is reserved.
  const broken = rows.reduce(
    (all, row, i) => all.concat(i > 0 ? ['\n'] : [], (legend.data as unknown[]).slice(row.first, rows[i + 1]?.first)),
    [] as unknown[],
  );
  const { width: _, overflow: __, ...style } = legend.textStyle as Part;
  const textStyle = { ...style, fontSize: 11, lineHeight: kLine_px };
  return {
    legend: {
      ...legend,
      data: is_paged ? legend.data : broken,
      type: is_paged ? 'scroll' : 'plain',
      orient: 'horizontal',
      left: kEdge_px,
      right: kEdge_px,
      top: 4,
      bottom: undefined,
      padding: 0,
      itemGap: kGap_px,
      itemWidth: kSymbol_px,
      textStyle: is_fixed || is_paged ? { ...textStyle, width: text_px, overflow: is_paged ? 'truncate' : 'break' } : textStyle,
    },
    height_px: is_paged ? kLine_px + kGap_px : rows.reduce((sum, row) => sum + row.height_px + kGap_px, 0),
  };
}

// Returns a position of ECharts, such as 20 or "7.5%", in pixels.
function to_px(position: unknown, whole_px: number): number {
  return typeof position === 'string' ? (parseFloat(position) / 100) * whole_px : Number(position);
}

function fit_panels(option: Part, grids: Part[], from: { width_px: number; height_px: number }, head_px: number): FittedChart {
  const is_square = typeof grids[0].width === 'number'; // such panels have a scale and keep it
  const panel_px = to_px(grids[0].height, from.height_px);
  const places = grids.map((grid, i) => ({
    left: kLeft_px,
    width: is_square ? grid.width : from.width_px - kLeft_px - kRight_px,
    top: head_px + i * (panel_px + kBelow_px),
    height: panel_px,
  }));
  const titles = option.title as Part[] | undefined;
  // Panels below each other share the name of their axis, which then stands below the last one.
  const axes = (option.xAxis as Part[]).map((axis, i) => (is_square || i === grids.length - 1 ? axis : { ...axis, name: '' }));
  return {
    option: {
      ...option,
      grid: grids.map((grid, i) => ({ ...grid, ...places[i] })),
      title: titles?.map((title, i) => ({ ...title, left: places[i].left, top: places[i].top })),
      xAxis: axes,
    },
    height_px: head_px + grids.length * (panel_px + kBelow_px) + 8,
  };
}

// Returns the chart `drawn`, which is `height_px` high, for a place of `width_px`. A wide place gets it
// unchanged. In a narrow one, the options in `narrow` of a grid replace those of the grid itself;
// its `head` is the height in pixels between the legend and the grid.
export function fit_width(drawn: EChartsOption, width_px: number, height_px: number): FittedChart {
  if (width_px >= kNarrow_px || drawn.grid === undefined) {
    return { option: drawn, height_px };
  }
  const option: Part = { ...drawn };
  const shown = option.legend as Part | undefined;
  let legend_px = 0;
  if (shown !== undefined && shown.show !== false) {
    const fitted = fit_legend(shown, width_px);
    option.legend = fitted.legend;
    legend_px = fitted.height_px;
  }
  const grids = Array.isArray(option.grid) ? (option.grid as Part[]) : [option.grid as Part];
  const top_px = to_px(grids[0].top, height_px);
  const narrow = (grids[0].narrow as Part | undefined) ?? {};
  const head_px = legend_px === 0 ? top_px : legend_px + Number(narrow.head ?? kHead_px);
  if (grids.length > 1) {
    return fit_panels(option, grids, { width_px, height_px }, head_px);
  }
  const was_beside = shown?.orient === 'vertical' && shown.left === undefined && legend_px > 0;
  const grid = { ...grids[0], ...narrow };
  const left = to_px(grid.left, width_px);
  const right = was_beside ? kRight_px : to_px(grid.right, width_px);
  const scale = Math.min(1, (kMostMargin * width_px) / (left + right));
  option.grid = { ...grid, left: scale * left, right: scale * right, top: head_px };
  const below_px = to_px(grid.bottom, height_px) - to_px(grids[0].bottom, height_px);
  return { option, height_px: height_px + head_px - top_px + below_px };
}
