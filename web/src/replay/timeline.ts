// From the time of the replay to what there is to show. A moment is counted in control periods from
// the start: at 0 nothing has moved, at k > 0 the arm is in the state of row k - 1, which is that at
// the end of its control period. Nothing of the DOM.
import type { Motion, ReplayCase, Segment } from '../data';

export function clamp(value: number, lower: number, upper: number): number {
  return Math.min(upper, Math.max(lower, value));
}

// The last whole moment at this time. Times are sums of periods: what is just short of one is it.
export function find_moment(time_s: number, period_s: number, moments: number): number {
  return clamp(Math.floor(time_s / period_s + 1e-6), 0, moments);
}

// Index of the segment under way at this moment; at a segment's last moment it is still that one.
export function find_segment(segments: Segment[], moment: number): number {
  let low = 0;
  let high = segments.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (segments[middle].first_step < moment) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return Math.max(0, low);
}

// The moment at which the segment begins.
export function find_previous_point(segments: Segment[], moment: number): number {
  const here = find_segment(segments, moment);
  if (segments.length === 0) {
    return 0;
  }
  // Back from a segment's beginning means to the one before it.
  return segments[here].first_step;
}

// The moment at which the segment under way ends; at its end, that at which the following one does.
export function find_next_point(segments: Segment[], moment: number, moments: number): number {
  for (const segment of segments) {
    const end = segment.first_step + segment.steps;
    if (end > moment) {
      return Math.min(end, moments);
    }
  }
  return moments;
}

export function is_measured(segment: Segment, moment: number): boolean {
  return moment - 1 >= segment.first_step + segment.window_start && moment - 1 < segment.first_step + segment.steps;
}

// Joint positions at a time, between the rows along a straight line; beyond the motion's end its last.
export function interpolate_row(rows: ArrayLike<number>, width: number, count: number, start: ArrayLike<number>, moment: number): number[] {
  const place = clamp(moment, 0, count);
  const whole = Math.floor(place);
  const share = place - whole;
  const get = (k: number, i: number): number => (k === 0 ? start[i] : rows[(k - 1) * width + i]);
  const values: number[] = [];
  for (let i = 0; i < width; ++i) {
    const here = get(whole, i);
    values.push(share === 0 ? here : here + share * (get(Math.min(count, whole + 1), i) - here));
  }
  return values;
}

// "" while the motion goes on; a sentence once it has ended before the test case has.
export function describe_end(motion: Motion, replay: ReplayCase, moment: number, period_s: number): string {
  if (motion.steps >= replay.steps || moment < motion.steps) {
    return '';
  }
  const when = (motion.steps * period_s).toFixed(2);
  return `${motion.status} at ${when} s${motion.reason ? `: ${motion.reason}` : ''}`;
}
