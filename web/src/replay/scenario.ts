// A test case that is ready to be shown: its packed numbers are unpacked, and the paths of the tips
// are computed. This file does not use the DOM.
import type { DesignInfo, Motion, ReplayCase, ReplaySet, Robot } from '../data';
import { unpack } from '../numbers';
import { calc_tip, make_chain, type Chain } from './chain';
import { clamp, interpolate_row } from './timeline';

export interface Track {
  motion: Motion;
  name: string; // name of the design
  count: number; // number of rows
  q: Float32Array;
  errors_m: Float32Array; // one per moment; the first is that of the start
  tip_m: Float32Array; // 3 per moment
  effort: Float32Array; // one row of joints per row of q
  limits: [number | null, number | null][]; // of the efforts, one per joint
}

export interface Scenario {
  replay: ReplayCase;
  chain: Chain;
  period_s: number;
  moments: number; // index of the last moment
  target_m: Float32Array; // 3 per row
  is_recorded: boolean; // by a robot: then there are no target, no moves and no errors
  places_m: [number, number, number][]; // that the picture must show
  tracks: Track[];
}

const kMostPlaces = 200; // of a recorded motion

function make_track(motion: Motion, design: DesignInfo | undefined, replay: ReplayCase, chain: Chain): Track {
  const width = chain.robot.joints.length;
  const q = unpack(motion.q);
  const errors = unpack(motion.error_m);
  const is_recorded = replay.points_m.length === 0;
  const count = Math.min(motion.steps, Math.floor(q.length / width), is_recorded ? Infinity : errors.length);
  const tip_m = new Float32Array(3 * (count + 1));
  const errors_m = new Float32Array(count + 1);
  tip_m.set(calc_tip(chain, replay.start_q));
  if (!is_recorded) {
    const start = replay.points_m[0];
    errors_m[0] = Math.hypot(tip_m[0] - start[0], tip_m[1] - start[1], tip_m[2] - start[2]);
  }
  for (let k = 0; k < count; ++k) {
    tip_m.set(calc_tip(chain, q, width * k), 3 * (k + 1));
    errors_m[k + 1] = is_recorded ? 0 : errors[k];
  }
  const limits = design?.effort_limits ?? [];
  return { motion, name: design?.name ?? motion.design, count, q, errors_m, tip_m, effort: unpack(motion.effort), limits };
}

// Returns some places of a tip, evenly spread.
function choose_places(tip_m: Float32Array): [number, number, number][] {
  const moments = tip_m.length / 3;
  const stride = Math.ceil(moments / kMostPlaces);
  const places: [number, number, number][] = [];
  for (let k = 0; k < moments; k += stride) {
    places.push([tip_m[3 * k], tip_m[3 * k + 1], tip_m[3 * k + 2]]);
  }
  return places;
}

export function make_scenario(set: ReplaySet, replay: ReplayCase, robot: Robot): Scenario {
  const chain = make_chain(robot);
  const is_recorded = replay.points_m.length === 0;
  const tracks = replay.motions.map((motion) => {
    const design = set.designs.find((one) => one.id === motion.design);
    return make_track(motion, design, replay, chain);
  });
  return {
    replay,
    chain,
    period_s: set.task.control_period_s,
    moments: replay.steps,
    target_m: unpack(replay.target_m),
    is_recorded,
    places_m: is_recorded ? tracks.flatMap((track) => choose_places(track.tip_m)) : replay.points_m,
    tracks,
  };
}

export function find_q(scenario: Scenario, track: Track, moment: number): number[] {
  return interpolate_row(track.q, scenario.chain.robot.joints.length, track.count, scenario.replay.start_q, moment);
}

export function find_target(scenario: Scenario, moment: number): [number, number, number] | null {
  if (scenario.is_recorded) {
    return null;
  }
  const [x, y, z] = interpolate_row(scenario.target_m, 3, scenario.moments, scenario.replay.points_m[0], moment);
  return [x, y, z];
}

// Returns the error at a moment, or null after the end of the motion.
export function find_error(track: Track, moment: number): number | null {
  return moment > track.count ? null : track.errors_m[clamp(moment, 0, track.count)];
}
