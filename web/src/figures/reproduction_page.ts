// The page of the repeated thesis: its figures, each beside the published numbers.
import { shorten_all } from '../charts/names';
import type { DistanceResponse, ReproductionData, SignalCurve } from '../data';
import type { Cell, Column, Figure, Item, Tab, TableItem, Value } from '../model';
import { kMillimetres, unpack } from '../numbers';
import { make_agreement_headline, make_agreement_table } from './agreement';
import { make_response_figure } from './distance_response';
import { make_class_figure, type ErrorTrace } from './momentary';
import { make_published_figure } from './published';
import { is_number, times } from './quantities';
import { keep_filled } from './run_page';
import { make_reduction_figure, make_signal_figure } from './signals';
import { make_sweep_figure } from './sweep';
import { make_case_figure } from './trajectory';

// The tabs of the parts of the thesis that have figures of responses.
const kTabs: { id: string; title: string; responses: string[] }[] = [
  { id: 'initial', title: 'First experiment', responses: ['fig-5.9', 'fig-5.11'] },
  { id: 'q1', title: 'Q1: signals', responses: ['fig-6.4'] },
  { id: 'q2', title: 'Q2: torque', responses: ['fig-6.9', 'fig-6.10', 'fig-6.11', 'fig-6.12', 'fig-6.13'] },
  { id: 'q3', title: 'Q3: load', responses: ['fig-6.15'] },
];

// The figures 6.5-6.8 and their distance classes.
const kClasses: [string, number, number][] = [
  ['6.5', 2, 7],
  ['6.6', 8, 13],
  ['6.7', 14, 19],
  ['6.8', 20, 25],
];

const millimetres = (label: string): Column => ({ label, unit: 'mm', numeric: true });
const torque = (label: string): Column => ({ label, unit: 'N m', numeric: true, digits: 6 });
const number = (label: string): Column => ({ label, numeric: true });

// A figure that is alone in its tab has the full width of the page.
function make_response(response: DistanceResponse, count: number): Figure {
  const figure = make_response_figure(response);
  return count === 1 ? { ...figure, width: 'full', height: 420 } : figure;
}

function get_ratio(ours: number | null, published: number | null): number | null {
  return is_number(ours) && is_number(published) && published !== 0 ? ours / published : null;
}

function make_results(data: ReproductionData): TableItem | null {
  if (data.rows.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'results',
    title: 'Published results, simulated again',
    caption:
      'The published designs on a test set like that of the thesis, with other random numbers, beside the values that the thesis printed. ' +
      'A ratio of 1 means that both agree. Each row has the command that makes it.',
    table: {
      columns: [
        { label: 'result' },
        { label: 'design' },
        { label: 'problem' },
        { label: 'changed' },
        { label: 'where' },
        millimetres('published'),
        millimetres('mean'),
        number('ratio'),
        millimetres('median'),
        millimetres('95 %'),
        millimetres('worst'),
        number('failures'),
        number('cases'),
        torque('published torque'),
        torque('torque'),
      ],
      rows: data.rows.map((row): (Value | Cell)[] => [
        { value: row.label, command: row.command || undefined },
        row.design,
        row.problem,
        row.overrides.join(', '),
        row.where,
        times(row.published_error_m, kMillimetres),
        { value: times(row.mean_m, kMillimetres), command: row.command || undefined },
        get_ratio(row.mean_m, row.published_error_m),
        times(row.median_m, kMillimetres),
        times(row.p95_m, kMillimetres),
        times(row.worst_m, kMillimetres),
        row.failures,
        row.cases,
        row.published_torque_n_m,
        row.torque_n_m,
      ]),
    },
  };
}

function make_runs(data: ReproductionData): TableItem | null {
  if (data.runs.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'runs',
    title: 'Optimized anew',
    caption:
      'Experiments for which the thesis gives no design. They were optimized again as the thesis describes, and the new winners are shown.',
    table: {
      columns: [
        { label: 'run' },
        { label: 'problem' },
        number('cases'),
        millimetres('mean'),
        torque('torque'),
        torque('published torque'),
        number('ratio'),
        { label: 'folder' },
      ],
      rows: data.runs.map((row): (Value | Cell)[] => [
        { value: row.name, command: row.command || undefined },
        row.problem,
        row.cases,
        times(row.mean_m, kMillimetres),
        row.torque_n_m,
        row.published_torque_n_m,
        get_ratio(row.torque_n_m, row.published_torque_n_m),
        row.folder,
      ]),
    },
  };
}

// Makes Table 6.4: the torques that the thesis printed and those of the designs here.
function make_torques(data: ReproductionData): TableItem | null {
  const rows: (Value | Cell)[][] = [];
  data.rows
    .filter((row) => row.published_torque_n_m !== null)
    .forEach((row) => {
      rows.push([
        { value: row.label, command: row.command || undefined },
        'published design',
        row.published_torque_n_m,
        row.torque_n_m,
        get_ratio(row.torque_n_m, row.published_torque_n_m),
      ]);
    });
  data.runs
    .filter((run) => run.published_torque_n_m !== null)
    .forEach((run) => {
      rows.push([
        { value: run.name, command: run.command || undefined },
        'optimized anew',
        run.published_torque_n_m,
        run.torque_n_m,
        get_ratio(run.torque_n_m, run.published_torque_n_m),
      ]);
    });
  if (rows.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'table-6.4',
    title: 'Total torque',
    thesis: 'Table 6.4',
    caption:
      'The total torque is a sum over the joints: of the two torque limits of each joint it takes the one with the larger magnitude. The torque of a published design follows from its numbers. ' +
      'A winner that was optimized again is another design, so at best its torque has a similar size.',
    table: {
      columns: [{ label: 'experiment' }, { label: 'design' }, torque('published'), torque('here'), number('ratio')],
      rows,
    },
  };
}

function make_momentary_figures(data: ReproductionData): Figure[] {
  const traces: ErrorTrace[] = [];
  const names = shorten_all(data.momentary.map((entry) => entry.name));
  data.momentary.forEach((entry, style) => {
    const set = data.replays.filter((one) => one.id === entry.replay)[0];
    const one = set ? set.cases.filter((each) => each.id === entry.case)[0] : undefined;
    const motion = one ? one.motions.filter((each) => each.design === entry.design)[0] : undefined;
    if (set && one && motion) {
      traces.push({ name: names[style], style, set, one, error_m: unpack(motion.error_m) });
    }
  });
  if (traces.length === 0) {
    return [];
  }
  return kClasses
    .filter(([, first]) => traces[0].one.segments.length >= first)
    .map(([figure, first, last]) => make_class_figure(traces, first, last, `fig-${figure}`, `Fig. ${figure}`));
}

function make_signal_items(data: ReproductionData): Item[] {
  const { signals } = data;
  const find = (names: string[]): SignalCurve[] =>
    signals.curves.filter((curve) => names.some((name) => curve.name.toLowerCase().indexOf(name) === 0));
  const step = find(['step']);
  const smooth = signals.curves.filter((curve) => step.indexOf(curve) < 0);
  const pair = find(['triangular', 'complex']);
  const complex = find(['complex']);
  const figures: (Figure | null)[] = [
    step.length > 0
      ? make_signal_figure(signals, step, ['distance'], {
          id: 'fig-5.5',
          title: 'Step reference signal',
          thesis: 'Fig. 5.5',
          remark: 'The target is at the end of the move at once.',
        })
      : null,
    smooth.length > 0
      ? make_signal_figure(signals, smooth, ['speed', 'distance'], {
          id: 'fig-5.6',
          title: 'Reference signals with a course',
          thesis: 'Fig. 5.6',
          remark: 'The smoother the signal, the higher its peak speed.',
        })
      : null,
    pair.length > 0
      ? make_signal_figure(signals, pair, ['acceleration'], {
          id: 'fig-5.7',
          title: 'Accelerations of Triangular and Complex',
          thesis: 'Fig. 5.7',
          remark: 'Complex slows down less and less, so its acceleration has no jump at the end.',
        })
      : null,
    complex.length > 0
      ? make_signal_figure(signals, complex, ['speed', 'distance'], {
          id: 'fig-5.8',
          title: 'The Complex reference signal',
          thesis: 'Fig. 5.8',
          remark:
            'At t_d, after 2/5 of the move, the target begins to slow down. At t_m it has arrived, and from then on the error is measured.',
          marks: true,
        })
      : null,
    signals.reduction.distance_m.length > 0 ? make_reduction_figure(signals, 'fig-5.10', 'Fig. 5.10') : null,
    data.replays.length > 0 ? make_case_figure(data.replays[0], 'fig-5.12', 'Fig. 5.12') : null,
  ];
  return figures.filter((figure): figure is Figure => figure !== null);
}

export function make_reproduction_tabs(data: ReproductionData): Tab[] {
  const usable = data.responses.filter((one) => one.series.length > 0);
  const is_placed = (one: DistanceResponse) => kTabs.some((tab) => tab.responses.indexOf(one.id) >= 0);
  const more: Record<string, (Item | null)[]> = {
    q1: make_momentary_figures(data),
    q2: [make_torques(data)],
  };
  return keep_filled([
    {
      id: 'overview',
      title: 'Overview',
      items: [
        make_agreement_headline(data),
        make_agreement_table(data),
        make_published_figure(data),
        make_results(data),
        make_runs(data),
        ...usable.filter((one) => !is_placed(one)).map((one, _, all) => make_response(one, all.length)),
        data.facts.length > 0 ? { kind: 'facts', id: 'facts', title: 'About', facts: data.facts } : null,
      ],
    },
    ...kTabs.map((tab) => ({
      id: tab.id,
      title: tab.title,
      items: [
        ...usable.filter((one) => tab.responses.indexOf(one.id) >= 0).map((one, _, all) => make_response(one, all.length)),
        ...(more[tab.id] ?? []),
      ],
    })),
    {
      id: 'q4',
      title: 'Q4: speed',
      items: [data.sweep && data.sweep.series.length > 0 ? make_sweep_figure(data.sweep, 'fig-6.16', 'Fig. 6.16') : null],
    },
    { id: 'signals', title: 'Signals', items: make_signal_items(data) },
    {
      id: 'replay',
      title: 'Replay',
      items: data.replays.length > 0 ? [{ kind: 'replay', id: 'replay', title: 'Replay', sets: data.replays }] : [],
    },
  ]);
}
