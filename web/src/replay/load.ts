// How near each joint is to a limit, as colours of the links: by the torque of the joint or by its
// position. This file does not use the DOM.
import { find_limit_share, kAtLimit } from '../figures/quantities';
import type { Look } from '../charts/look';
import type { Scenario, Track } from './scenario';

export type Paint = 'robot' | 'torque' | 'position';

// The lower ends of the bands of shares, in percent. The last band is the limit itself. Most torques
// are small shares of their limits.
const kBands: Record<Paint, number[]> = { robot: [], torque: [0, 10, 25, 50, 100], position: [0, 50, 75, 90, 100] };

// The bands below the limit are ordered by lightness, away from the background.
const kOnLight = ['#dbe1e7', '#a3c6e2', '#5090c6', '#1f4e86'];
const kOnDark = ['#39424d', '#3f6f9e', '#6aa5db', '#b9dbf7'];

// Returns one share per joint: of the torque in its limit, or of the way from the middle of the
// joint's range to its end. A joint without a limit has null, and so has a torque after the motion.
export function find_shares(scenario: Scenario, track: Track | null, moment: number, q: number[], paint: Paint): (number | null)[] {
  const { joints } = scenario.chain.robot;
  const row = Math.ceil(moment) - 1; // the torque of a control period leads to the state at its end
  return joints.map((joint, i) => {
    if (paint === 'torque') {
      const is_moving = track !== null && row >= 0 && row < track.count;
      return is_moving ? find_limit_share(track.effort[row * joints.length + i], track.limits[i]) : null;
    }
    if (joint.lower === null || joint.upper === null || !(joint.upper > joint.lower)) {
      return null;
    }
    return Math.abs((2 * (q[i] - joint.lower)) / (joint.upper - joint.lower) - 1);
  });
}

// Returns the colours with their meanings, the smallest share first.
export function list_paints(look: Look, paint: Paint): { colour: string; label: string }[] {
  const ends = kBands[paint];
  const colours = [...(look.theme === 'light' ? kOnLight : kOnDark), look.bad];
  return ends.map((end, i) => ({ colour: colours[i], label: i < ends.length - 1 ? `${end} to ${ends[i + 1]} %` : 'at the limit' }));
}

// Returns the colour of a link with this share.
export function find_colour_of(share: number | null, look: Look, paint: Paint): string {
  const bands = list_paints(look, paint);
  const reached = share === null ? 0 : kBands[paint].filter((begin) => share >= (begin / 100) * kAtLimit).length;
  return reached === 0 ? look.muted : bands[reached - 1].colour;
}

export function describe_share(share: number | null): string {
  return share === null ? '–' : share >= kAtLimit ? 'at the limit' : `${(100 * share).toFixed(0)} %`;
}
