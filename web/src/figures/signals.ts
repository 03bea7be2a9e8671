// The reference signals (Fig. 5.5-5.8 of the thesis), and how short moves are slowed down (Fig.
// 5.10).
import { decimate } from '../charts/decimate';
import type { Look } from '../charts/look';
import { get_line_style, make_number_axis, make_panel_title, make_panels, make_curve_plot, make_vertical } from '../charts/marks';
import { shorten_all } from '../charts/names';
import { make_line, type Part, type Point } from '../charts/parts';
import type { SignalCurve, Signals } from '../data';
import type { DataTable, Figure, Value } from '../model';
import { format_number } from '../numbers';
import { flatten, is_number } from './quantities';

export type SignalPart = 'distance' | 'speed' | 'acceleration';

interface PartInfo {
  label: string;
  unit: string;
  get(curve: SignalCurve): number[];
}

const kParts: Record<SignalPart, PartInfo> = {
  distance: { label: 'distance', unit: 'm', get: (curve) => curve.distance_m },
  speed: { label: 'speed', unit: 'm/s', get: (curve) => curve.speed_m_per_s },
  acceleration: { label: 'acceleration', unit: 'm/s²', get: (curve) => curve.acceleration_m_per_s2 },
};

const kCurvePoints = 400;

function make_points(x: number[], y: (number | null)[]): Point[] {
  const numbers = x.map((_, i) => (is_number(y[i]) ? (y[i] as number) : NaN));
  return decimate(numbers, kCurvePoints).map((i): Point => [x[i], is_number(y[i]) ? y[i] : null]);
}

function draw_curves(look: Look, signals: Signals, curves: SignalCurve[], names: string[], part: SignalPart, axis: number): Part[] {
  return curves.map((curve, i) =>
    make_line(look, i, names[i], make_points(curve.time_s, kParts[part].get(curve)), {
      axis,
      width: curve.name === signals.used ? 3 : 1.6,
      style: get_line_style(look, find_curve(signals, curve)),
    }),
  );
}

// Returns the index of a curve among all, so that it keeps its colour if others are left out.
function find_curve(signals: Signals, curve: SignalCurve): number {
  return Math.max(0, signals.curves.indexOf(curve));
}

function tabulate(curves: SignalCurve[], parts: SignalPart[]): DataTable {
  const rows: Value[][] = [];
  curves.forEach((curve) => {
    curve.time_s.forEach((time, i) => {
      rows.push([curve.name, time, ...parts.map((part): Value => kParts[part].get(curve)[i] ?? null)]);
    });
  });
  return {
    columns: [
      { label: 'signal' },
      { label: 'time', unit: 's', numeric: true },
      ...parts.map((part) => ({ label: kParts[part].label, unit: kParts[part].unit, numeric: true })),
    ],
    rows,
  };
}

export interface SignalOptions {
  id: string;
  title: string;
  thesis?: string;
  remark?: string;
  marks?: boolean; // whether t_d and t_m of the first curve are marked
}

// Makes one panel per part. Each panel has all the curves.
export function make_signal_figure(signals: Signals, curves: SignalCurve[], parts: SignalPart[], options: SignalOptions): Figure {
  const names = shorten_all(curves.map((curve) => curve.name));
  const used = curves.filter((curve) => curve.name === signals.used)[0];
  const height = 340;
  return {
    kind: 'figure',
    id: options.id,
    title: options.title,
    thesis: options.thesis,
    height,
    time: { replay: 'signals', case: () => `${signals.distance_m} m` },
    caption:
      `${parts.map((part) => kParts[part].label).join(' and ')} of the target on its straight line, in a move over `.replace(
        /^./,
        (letter) => letter.toUpperCase(),
      ) +
      `${format_number(signals.distance_m, 3)} m at an average speed of ${format_number(signals.speed_m_per_s, 3)} m/s, ` +
      `and while it rests for ${format_number(signals.rest_s, 2)} s. ` +
      (used && curves.length > 1 ? `The bold line is ${names[curves.indexOf(used)]}, which this problem uses. ` : '') +
      (options.remark ?? ''),
    draw: (look) => {
      const grids = make_panels(parts.length, parts.length, height);
      const series = flatten(parts.map((part, i) => draw_curves(look, signals, curves, names, part, i)));
      if (options.marks) {
        parts.forEach((_, i) =>
          get_marks(signals, curves[0]).forEach((mark) => series.push(make_vertical(look, mark.time_s, mark.name, look.muted, i))),
        );
      }
      return make_curve_plot(
        look,
        parts.map((_, i) => make_number_axis(look, 'x', 'time (s)', { index: i, min: 0, max: 'dataMax' })),
        parts.map((part, i) =>
          make_number_axis(look, 'y', parts.length > 1 ? '' : `${kParts[part].label} (${kParts[part].unit})`, { index: i }),
        ),
        series,
        {
          grid: grids,
          title:
            parts.length > 1
              ? parts.map((part, i) => make_panel_title(look, grids[i], `${kParts[part].label} (${kParts[part].unit})`))
              : undefined,
        },
      );
    },
    table: () => tabulate(curves, parts),
  };
}

interface Mark {
  name: string;
  time_s: number;
}

// Returns the times at which the target begins to slow down and at which it arrives. Errors count
// from the arrival.
function get_marks(signals: Signals, curve: SignalCurve): Mark[] {
  let top = 0;
  curve.speed_m_per_s.forEach((speed, i) => {
    if (is_number(speed) && speed > (curve.speed_m_per_s[top] ?? 0)) {
      top = i;
    }
  });
  return [
    { name: 't_d', time_s: curve.time_s[top] },
    { name: 't_m', time_s: signals.distance_m / signals.speed_m_per_s },
  ];
}

export function make_signal_figures(signals: Signals): Figure[] {
  if (signals.curves.length === 0) {
    return [];
  }
  const one = (part: SignalPart, remark: string) =>
    make_signal_figure(signals, signals.curves, [part], { id: `signals-${part}`, title: `Reference signals: ${part}`, remark });
  return [
    one('distance', 'The tip should have moved this distance at that time.'),
    one('speed', 'For the same distance in the same time, a smoother signal needs a higher peak speed.'),
    one(
      'acceleration',
      'Jumps excite the arm: with fewer and smaller jumps the motion is smoother. At a jump of the speed the acceleration is not defined.',
    ),
  ];
}

export function make_reduction_figure(signals: Signals, id = 'speed-reduction', thesis = ''): Figure {
  const { reduction } = signals;
  return {
    kind: 'figure',
    id,
    title: 'Speed of short moves',
    thesis: thesis || undefined,
    caption:
      `The average speed of a move against its distance. ` +
      (reduction.limit_m > 0
        ? `Below the distance limit of ${format_number(reduction.limit_m, 3)} m (dashed line) the speed is proportional to the distance, so that short moves are not the worst ones.`
        : `There is no distance limit, so all moves have the same speed.`),
    draw: (look) =>
      make_curve_plot(
        look,
        make_number_axis(look, 'x', 'distance (m)', { max: 'dataMax' }),
        make_number_axis(look, 'y', 'average speed (m/s)', { min: 0 }),
        [
          make_line(look, 0, 'speed', make_points(reduction.distance_m, reduction.speed_m_per_s), { width: 2.2 }),
          ...(reduction.limit_m > 0 ? [make_vertical(look, reduction.limit_m, 'distance limit', look.muted, 0, true)] : []),
        ],
      ),
    table: () => ({
      columns: [
        { label: 'distance', unit: 'm', numeric: true },
        { label: 'average speed', unit: 'm/s', numeric: true },
      ],
      rows: reduction.distance_m.map((distance, i) => [distance, reduction.speed_m_per_s[i] ?? null]),
    }),
  };
}
