// Converts the time of the replay to moments. A moment is a number of control periods since the
// start. At moment 0 nothing has moved. At moment k > 0 the arm is in the state of row k - 1, which
// is the state at the end of control period k - 1. This file does not use the DOM.
import type { Motion, ReplayCase, Segment } from '../data';

export function clamp(value: number, lower: number, upper: number): number {
  return Math.min(upper, Math.max(lower, value));
}

// Returns the last whole moment at this time. Times are sums of periods, so a time just before a
// moment counts as that moment.
export function find_moment(time_s: number, period_s: number, moments: number): number {
  return clamp(Math.floor(time_s / period_s + 1e-6), 0, moments);
}

// Returns the index of the segment at this moment. The last moment of a segment still belongs to
// it.
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

// Returns the moment at which the segment begins.
export function find_previous_point(segments: Segment[], moment: number): number {
  const here = find_segment(segments, moment);
  if (segments.length === 0) {
    return 0;
  }
  // At the beginning of a segment, go back to the segment before it.
  return segments[here].first_step;
}

// Returns the moment at which the current segment ends. At this moment itself, returns the end of
// the next segment.
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

// Returns the joint positions at a moment, interpolated linearly between rows. After the end of the
// motion, returns the last row.
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

// Returns "" during the motion. If the motion ends before the test case, returns a sentence that
// says so.
export function describe_end(motion: Motion, replay: ReplayCase, moment: number, period_s: number): string {
  if (motion.steps >= replay.steps || moment < motion.steps) {
    return '';
  }
  const when = (motion.steps * period_s).toFixed(2);
  return `${motion.status} at ${when} s${motion.reason ? `: ${motion.reason}` : ''}`;
}
