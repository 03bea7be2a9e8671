// The points of the trajectory of a test case (Fig. 5.12 of the thesis), from above and from the
// side.
import { get_series_style, type Look } from '../charts/look';
import { make_number_axis, make_plot } from '../charts/marks';
import type { Part } from '../charts/parts';
import type { ReplayCase, ReplaySet } from '../data';
import type { Figure } from '../model';
import { format_number } from '../numbers';
import { get_case, make_case_choice } from './replay_access';

// Both axes of both panels have the same number of pixels, whatever the width of the figure, so
// that they have one scale.
const kSide = 226;
const kLefts = [60, 352];
const kTop = 46;
const kViews: { name: string; axes: [number, number]; names: [string, string] }[] = [
  { name: 'from above', axes: [0, 1], names: ['x (m)', 'y (m)'] },
  { name: 'from the side', axes: [0, 2], names: ['x (m)', 'z (m)'] },
];

interface Frame {
  centre: number[];
  half: number;
}

// Returns a cube around all points.
function find_frame(one: ReplayCase): Frame {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  one.points_m.forEach((point) => {
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], point[axis]);
      high[axis] = Math.max(high[axis], point[axis]);
    }
  });
  let half = 0.01;
  const centre = low.map((value, axis) => {
    half = Math.max(half, 0.6 * (high[axis] - value)); // the numbers of the points are above them
    return (value + high[axis]) / 2;
  });
  // Round ends make round ticks.
  const step = Math.pow(10, Math.floor(Math.log(half) / Math.LN10));
  return {
    centre: centre.map((value) => Math.round(value / (step / 5)) * (step / 5)),
    half: Math.ceil(half / (step / 5)) * (step / 5),
  };
}

function label_of(look: Look): Part {
  return make_number_axis(look, 'x', '').axisLabel as Part;
}

function draw_view(look: Look, one: ReplayCase, view: number): Part[] {
  const { axes } = kViews[view];
  const points = one.points_m.map((point) => [point[axes[0]], point[axes[1]]]);
  const path = get_series_style(look, 0);
  const ends = [
    { i: 0, name: 'start', symbol: 'rect', color: get_series_style(look, 2).color },
    { i: points.length - 1, name: 'end', symbol: 'diamond', color: get_series_style(look, 1).color },
  ];
  return [
    {
      type: 'line',
      name: 'path',
      data: points.map((value, i) => ({
        value,
        note: `Point ${i}: ${one.points_m[i].map((each) => format_number(each)).join(', ')} m.`,
      })),
      symbol: 'circle',
      showSymbol: true,
      showAllSymbol: true,
      symbolSize: 5,
      lineStyle: { color: path.color, width: 1, opacity: 0.7 },
      itemStyle: { color: path.color },
      label: {
        show: true,
        formatter: (item: { dataIndex: number }) => String(item.dataIndex),
        position: 'top',
        distance: 3,
        color: look.text,
        fontFamily: look.font,
        fontSize: 10,
        textBorderColor: look.background,
        textBorderWidth: 2,
      },
      labelLayout: { hideOverlap: true },
      xAxisIndex: view,
      yAxisIndex: view,
    },
    ...ends.map((end) => ({
      type: 'scatter',
      name: end.name,
      data: [points[end.i]],
      symbol: end.symbol,
      symbolSize: 11,
      itemStyle: { color: end.color, borderColor: look.background, borderWidth: 1 },
      xAxisIndex: view,
      yAxisIndex: view,
      z: 5,
    })),
  ];
}

export function make_case_figure(set: ReplaySet, id = 'test-case', thesis = ''): Figure | null {
  const usable = set.cases.filter((one) => one.points_m.length > 1);
  if (usable.length === 0) {
    return null;
  }
  const shown: ReplaySet = { ...set, cases: usable };
  return {
    kind: 'figure',
    id,
    title: 'Trajectory points of a test case',
    thesis: thesis || undefined,
    caption:
      'The points that the tip has to visit one after the other, from above and from the side, in the frame of the base and on one scale. ' +
      'The target moves between them on straight lines. The first move goes from the centre of the workspace to its edge, the second move goes across it, ' +
      'and each further move is shorter than the one before. Numbers that would cover each other are left out. The table has all points.',
    height: 340,
    choices: usable.length > 1 ? [make_case_choice(shown)] : undefined,
    draw: (look, picked) => {
      const one = get_case(shown, picked);
      const frame = find_frame(one);
      const axis = (view: number, which: 0 | 1) => {
        const centre = frame.centre[kViews[view].axes[which]];
        return make_number_axis(
          look,
          which === 0 ? 'x' : 'y',
          kViews[view].names[which],
          { index: view, min: centre - frame.half, max: centre + frame.half },
          { nameGap: which === 0 ? 26 : 36, splitNumber: 4, axisLabel: { ...label_of(look), showMinLabel: false, showMaxLabel: false } },
        );
      };
      return make_plot(look, [axis(0, 0), axis(1, 0)], [axis(0, 1), axis(1, 1)], [...draw_view(look, one, 0), ...draw_view(look, one, 1)], {
        grid: kLefts.map((left) => ({ left, top: kTop, width: kSide, height: kSide })),
        title: kViews.map((view, i) => ({
          text: view.name,
          left: kLefts[i],
          top: kTop,
          padding: [-15, 0, 0, 2],
          textStyle: { color: look.text, fontFamily: look.font, fontSize: 12, fontWeight: 'normal' },
        })),
      });
    },
    table: (picked) => {
      const one = get_case(shown, picked);
      return {
        columns: [
          { label: 'point', numeric: true },
          { label: 'x', unit: 'm', numeric: true },
          { label: 'y', unit: 'm', numeric: true },
          { label: 'z', unit: 'm', numeric: true },
          { label: 'distance of the move', unit: 'm', numeric: true },
        ],
        rows: one.points_m.map((point, i) => [i, point[0], point[1], point[2], i === 0 ? null : (one.segments[i - 1]?.distance_m ?? null)]),
      };
    },
  };
}
