// The numbers beside the view, and the meaning of its colours.
import { make } from '../app/dom';
import { format_number, kDegrees, kMillimetres } from '../numbers';
import { list_decades, to_css, type ColourScale } from './colours';
import { describe_share, find_colour_of, list_paints, type Paint } from './load';
import { find_error, type Scenario, type Track } from './scenario';
import { kGhost } from './stage';
import { describe_end, is_measured } from './timeline';
import type { Look } from '../charts/look';

export interface Shown {
  scenario: Scenario;
  track: Track | null;
  ghost: Track | null;
  paint: Paint;
}

function make_swatch(colour: string): HTMLElement {
  const mark = make('span', { class: 'replay-swatch' });
  mark.style.background = colour;
  return mark;
}

class Row {
  readonly element: HTMLElement;
  private readonly value = make('dd');
  private readonly swatch: HTMLElement | null;

  constructor(label: string, colour = '') {
    this.swatch = colour === '' ? null : make_swatch(colour);
    this.element = make('div', {}, make('dt', {}, this.swatch, label), this.value);
  }

  set(text: string, colour = ''): void {
    if (this.value.textContent !== text) {
      this.value.textContent = text;
    }
    if (this.swatch !== null && colour !== '') {
      this.swatch.style.background = colour;
    }
  }
}

const kPaintTitles: Record<Paint, string> = {
  robot: '',
  torque: 'Link: the torque of its joint, as a share of the limit',
  position: 'Link: the position of its joint, from the middle of its range (0 %) to an end (100 %)',
};

function format_error(track: Track, moment: number): string {
  const error = find_error(track, moment);
  return error === null ? 'ended' : `${format_number(error * kMillimetres, 3)} mm`;
}

// A number that rounds to 0 has no sign.
function format_position(value: number): string {
  return value.toFixed(2).replace(/^-0\.00$/, '0.00');
}

// Returns the effort of a joint at a moment after the start.
function find_effort(track: Track, moment: number, joint: number, joints: number): number | null {
  return moment > 0 && moment <= track.count ? track.effort[(moment - 1) * joints + joint] : null;
}

export class Panel {
  readonly element = make('div', { class: 'replay-panel' });
  private readonly end = make('p', { class: 'replay-end', role: 'status' });
  private rows: { time: Row; point: Row; distance: Row; measured: Row; errors: [Track, Row][]; joints: Row[] } | null = null;
  private shown: Shown | null = null;
  private look: Look | null = null;

  set(shown: Shown, scale: ColourScale, look: Look): void {
    this.shown = shown;
    const { scenario, track, ghost, paint } = shown;
    this.look = look;
    const errors: [Track, Row][] = [];
    if (track !== null) {
      errors.push([track, new Row(`Error, ${track.name}`)]);
    }
    if (ghost !== null) {
      errors.push([ghost, new Row(`Error, ${ghost.name} (ghost)`, kGhost)]);
    }
    const joints = scenario.chain.robot.joints.map((joint) => new Row(joint.name, paint === 'robot' ? '' : look.muted));
    this.rows = {
      time: new Row('Time'),
      point: new Row('Point', look.bad),
      distance: new Row('Its distance'),
      measured: new Row('Measured now'),
      errors,
      joints,
    };
    const { time, point, distance, measured } = this.rows;
    const first = scenario.is_recorded ? [time] : [time, point, distance, measured, ...errors.map((pair) => pair[1])];
    this.element.replaceChildren(
      make('dl', { class: 'replay-numbers' }, ...first.map((row) => row.element)),
      make('dl', { class: 'replay-numbers replay-joints' }, ...joints.map((row) => row.element)),
      this.end,
      this.make_legend(scale, look),
    );
  }

  // `shares` has one share per joint if the links are painted.
  show(moment: number, segment: number, q: number[], shares: (number | null)[] | null): void {
    if (this.rows === null || this.shown === null || this.look === null) {
      return;
    }
    const { scenario, track, ghost, paint } = this.shown;
    const { segments } = scenario.replay;
    const here = segments[segment];
    this.rows.time.set(`${(moment * scenario.period_s).toFixed(2)} of ${(scenario.moments * scenario.period_s).toFixed(2)} s`);
    this.rows.point.set(here === undefined ? '–' : `${segment + 1} of ${segments.length}`);
    this.rows.distance.set(here === undefined ? '–' : `${format_number(here.distance_m * kMillimetres, 4)} mm`);
    this.rows.measured.set(here !== undefined && is_measured(here, moment) ? 'yes' : 'no');
    for (const [one, row] of this.rows.errors) {
      row.set(format_error(one, moment));
    }
    const { look } = this;
    this.rows.joints.forEach((row, i) => {
      const revolute = scenario.chain.robot.joints[i].kind === 'revolute';
      const position = revolute ? `${format_position(q[i] * kDegrees)}°` : `${format_position(q[i] * kMillimetres)} mm`;
      const effort = scenario.is_recorded && track !== null ? find_effort(track, moment, i, this.rows?.joints.length ?? 0) : null;
      const unit = revolute ? 'N m' : 'N';
      const state = effort === null ? position : `${position}, ${format_number(effort, 3)} ${unit}`;
      row.set(
        shares === null ? state : `${position}, ${describe_share(shares[i])}`,
        shares === null ? '' : find_colour_of(shares[i], look, paint),
      );
    });
    const ends = [track, ghost]
      .map((one) => (one === null ? '' : describe_end(one.motion, scenario.replay, moment, scenario.period_s)))
      .map((text, i) => (text === '' ? '' : `${(i === 0 ? track : ghost)?.name ?? ''}: ${text}.`));
    const text = ends.filter((one) => one !== '').join(' ');
    if (this.end.textContent !== text) {
      this.end.textContent = text;
    }
  }

  private make_legend(scale: ColourScale, look: Look): HTMLElement {
    const bar = make('div', { class: 'replay-bar' });
    bar.style.background = `linear-gradient(to right, ${scale.stops.map(to_css).join(', ')})`;
    const ticks = make('div', { class: 'replay-ticks' });
    list_decades(scale).forEach((decade) => ticks.append(make('span', {}, format_number(decade * kMillimetres, 1))));
    const paint = this.shown?.paint ?? 'robot';
    const paints = [...list_paints(look, paint), { colour: look.muted, label: 'no limit, no number' }];
    return make(
      'div',
      { class: 'replay-legend' },
      ...(paint === 'robot'
        ? []
        : [
            make('div', {}, kPaintTitles[paint]),
            make('div', { class: 'replay-paints' }, ...paints.map((one) => make('span', {}, make_swatch(one.colour), one.label))),
          ]),
      ...(this.shown?.scenario.is_recorded
        ? [make('div', {}, make_swatch(look.accent), 'path of the tip')]
        : [make('div', {}, 'Error along the path of the tip (mm)'), bar, ticks, make('div', {}, make_swatch(look.text), 'target')]),
      make('div', {}, 'squares of the ground: 0.5 m'),
    );
  }
}
