// The interface of the parts that draw the arm: in three dimensions if the browser can, otherwise
// in lines.
import type { Look } from '../charts/look';
import type { ColourScale } from './colours';
import type { Scenario, Track } from './scenario';

export type TraceChoice = 'past' | 'move' | 'whole';
export type ViewChoice = 'perspective' | 'side' | 'front' | 'top';

// The data that do not change with the time.
export interface Setting {
  scenario: Scenario;
  track: Track | null;
  ghost: Track | null;
  scale: ColourScale;
  look: Look;
}

// The data of one moment.
export interface Snapshot {
  moment: number; // may have a fraction
  q: number[];
  ghost_q: number[] | null;
  target_m: [number, number, number] | null; // null: there is none
  segment: number;
  trace: TraceChoice;
  paints: string[] | null; // the colour of the link that each joint moves; null: the colours of the robot
}

export interface Stage {
  readonly element: HTMLElement;
  set_setting(setting: Setting): void;
  show(snapshot: Snapshot): void;
  set_view(view: ViewChoice): void;
  resize(width: number, height: number, pixel_ratio: number): void;
  dispose(): void;
}

export const kGhost = '#1f9e77'; // visible on light and dark ground; errors and arms never have this colour

// Returns the moments of a trace to draw faintly and those to draw fully, as [first, last] each.
export function find_trace_parts(setting: Setting, count: number, snapshot: Snapshot): { past: [number, number]; now: [number, number] } {
  const last = Math.min(count, Math.floor(snapshot.moment));
  const segment = setting.scenario.replay.segments[snapshot.segment];
  const first = Math.min(last, segment === undefined ? 0 : segment.first_step);
  switch (snapshot.trace) {
    case 'whole':
      return { past: [0, 0], now: [0, count] };
    case 'move':
      return { past: [0, 0], now: [first, last] };
    case 'past':
      return { past: [0, first], now: [first, last] };
  }
}
