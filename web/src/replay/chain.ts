// Computes where the bodies of the arm are for given joint positions, as src/sim/kinematics does:
//   T_i = T_(i-1) origin_i Rot(axis_i, q_i) or T_(i-1) origin_i Trans(q_i axis_i).
// This file does not use the DOM, so it can be tested without a browser.
import type { Pose, Robot } from '../data';

// A rigid motion, as the three rows of (R | t).
export type Frame = number[];

export const kIdentity: Frame = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

export function multiply(a: Frame, b: Frame): Frame {
  const product: Frame = new Array(12);
  for (let row = 0; row < 3; ++row) {
    const x = a[4 * row];
    const y = a[4 * row + 1];
    const z = a[4 * row + 2];
    for (let column = 0; column < 4; ++column) {
      product[4 * row + column] = x * b[column] + y * b[4 + column] + z * b[8 + column] + (column === 3 ? a[4 * row + 3] : 0);
    }
  }
  return product;
}

export function make_frame(pose: Pose): Frame {
  const [x, y, z, w] = pose.quaternion;
  const [px, py, pz] = pose.position;
  return [
    1 - 2 * (y * y + z * z),
    2 * (x * y - z * w),
    2 * (x * z + y * w),
    px,
    2 * (x * y + z * w),
    1 - 2 * (x * x + z * z),
    2 * (y * z - x * w),
    py,
    2 * (x * z - y * w),
    2 * (y * z + x * w),
    1 - 2 * (x * x + y * y),
    pz,
  ];
}

function turn(axis: [number, number, number], angle: number): Frame {
  const sine = Math.sin(angle / 2);
  const quaternion: Pose['quaternion'] = [axis[0] * sine, axis[1] * sine, axis[2] * sine, Math.cos(angle / 2)];
  return make_frame({ position: [0, 0, 0], quaternion });
}

function slide(axis: [number, number, number], distance: number): Frame {
  return [1, 0, 0, axis[0] * distance, 0, 1, 0, axis[1] * distance, 0, 0, 1, axis[2] * distance];
}

export interface Chain {
  robot: Robot;
  origins: Frame[];
  tip: Frame;
}

export function make_chain(robot: Robot): Chain {
  return { robot, origins: robot.joints.map((joint) => make_frame(joint.origin)), tip: make_frame(robot.tip) };
}

// Returns one frame per body in the world, the base first. `first` is the index in `q` of the first
// joint's position.
export function calc_frames(chain: Chain, q: ArrayLike<number>, first = 0): Frame[] {
  const frames: Frame[] = [kIdentity];
  chain.robot.joints.forEach((joint, i) => {
    const at_zero = multiply(frames[i], chain.origins[i]);
    const moved = joint.kind === 'revolute' ? turn(joint.axis, q[first + i]) : slide(joint.axis, q[first + i]);
    frames.push(multiply(at_zero, moved));
  });
  return frames;
}

export function find_position(frame: Frame): [number, number, number] {
  return [frame[3], frame[7], frame[11]];
}

export function calc_tip(chain: Chain, q: ArrayLike<number>, first = 0): [number, number, number] {
  const frames = calc_frames(chain, q, first);
  return find_position(multiply(frames[frames.length - 1], chain.tip));
}
