// The numbers beside the view, and the meaning of its colours.
import { make } from '../app/dom';
import { format_number, kDegrees, kMillimetres } from '../numbers';
import { list_decades, to_css, type ColourScale } from './colours';
import { find_error, type Scenario, type Track } from './scenario';
import { kGhost } from './stage';
import { describe_end, is_measured } from './timeline';
import type { Look } from '../charts/look';

export interface Shown {
  scenario: Scenario;
  track: Track | null;
  ghost: Track | null;
}

class Row {
  readonly element: HTMLElement;
  private readonly value = make('dd');

  constructor(label: string, swatch = '') {
    const name = make('dt', {}, label);
    if (swatch !== '') {
      const mark = make('span', { class: 'replay-swatch' });
      mark.style.background = swatch;
      name.prepend(mark);
    }
    this.element = make('div', {}, name, this.value);
  }

  set(text: string): void {
    if (this.value.textContent !== text) {
      this.value.textContent = text;
    }
  }
}

function format_error(track: Track, moment: number): string {
  const error = find_error(track, moment);
  return error === null ? 'ended' : `${format_number(error * kMillimetres, 3)} mm`;
}

export class Panel {
  readonly element = make('div', { class: 'replay-panel' });
  private readonly end = make('p', { class: 'replay-end', role: 'status' });
  private rows: { time: Row; point: Row; distance: Row; measured: Row; errors: [Track, Row][]; joints: Row[] } | null = null;
  private shown: Shown | null = null;

  set(shown: Shown, scale: ColourScale, look: Look): void {
    this.shown = shown;
    const { scenario, track, ghost } = shown;
    const errors: [Track, Row][] = [];
    if (track !== null) {
      errors.push([track, new Row(`Error, ${track.name}`)]);
    }
    if (ghost !== null) {
      errors.push([ghost, new Row(`Error, ${ghost.name} (ghost)`, kGhost)]);
    }
    const joints = scenario.chain.robot.joints.map((joint) => new Row(joint.name));
    this.rows = {
      time: new Row('Time'),
      point: new Row('Point', look.bad),
      distance: new Row('Its distance'),
      measured: new Row('Measured now'),
      errors,
      joints,
    };
    const { time, point, distance, measured } = this.rows;
    const first = [time, point, distance, measured, ...errors.map((pair) => pair[1])];
    this.element.replaceChildren(
      make('dl', { class: 'replay-numbers' }, ...first.map((row) => row.element)),
      make('dl', { class: 'replay-numbers replay-joints' }, ...joints.map((row) => row.element)),
      this.end,
      this.make_legend(scale, look),
    );
  }

  show(moment: number, segment: number, q: number[]): void {
    if (this.rows === null || this.shown === null) {
      return;
    }
    const { scenario, track, ghost } = this.shown;
    const { segments } = scenario.replay;
    const here = segments[segment];
    this.rows.time.set(`${(moment * scenario.period_s).toFixed(2)} of ${(scenario.moments * scenario.period_s).toFixed(2)} s`);
    this.rows.point.set(here === undefined ? '–' : `${segment + 1} of ${segments.length}`);
    this.rows.distance.set(here === undefined ? '–' : `${format_number(here.distance_m * kMillimetres, 4)} mm`);
    this.rows.measured.set(here !== undefined && is_measured(here, moment) ? 'yes' : 'no');
    for (const [one, row] of this.rows.errors) {
      row.set(format_error(one, moment));
    }
    this.rows.joints.forEach((row, i) => {
      const revolute = scenario.chain.robot.joints[i].kind === 'revolute';
      row.set(revolute ? `${(q[i] * kDegrees).toFixed(2)}°` : `${(q[i] * kMillimetres).toFixed(2)} mm`);
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
    const target = make('span', { class: 'replay-swatch' });
    target.style.background = look.text;
    return make(
      'div',
      { class: 'replay-legend' },
      make('div', {}, 'Error along the path of the tip (mm)'),
      bar,
      ticks,
      make('div', {}, target, 'target'),
      make('div', {}, 'squares of the ground: 0.5 m'),
    );
  }
}
