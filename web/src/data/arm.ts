// The arm and its motions: the part of the page's data that runs, studies and the repeated thesis share.
import type { Packed, Quantity } from '../data';

export interface Pose {
  position: [number, number, number];
  quaternion: [number, number, number, number]; // x y z w
}

export interface Shape {
  kind: 'box' | 'cylinder' | 'sphere' | 'mesh';
  size: [number, number, number]; // box: edges; cylinder: radius, length along z, 0; sphere: radius, 0, 0; mesh: scale
  mesh: number | null; // index into Robot.meshes
  pose: Pose; // in the frame of the body
  rgba: [number, number, number, number];
}

export interface Body {
  name: string;
  shapes: Shape[];
}

export interface RobotJoint {
  name: string;
  kind: 'revolute' | 'prismatic';
  origin: Pose; // in the frame of the parent body, at position 0
  axis: [number, number, number];
  lower: number | null; // null: no limit
  upper: number | null;
}

export interface Mesh {
  positions: Packed; // 3 per vertex
  indices: Packed; // 3 per triangle
}

export interface Robot {
  name: string;
  bodies: Body[]; // the base, then the body that each joint moves
  joints: RobotJoint[];
  tip: Pose; // in the frame of the last body
  meshes: Mesh[];
}

export interface DesignInfo {
  id: string;
  name: string; // "winner", "base controllers", "published"
  total_torque_n_m: number | null; // of the joints that turn; null if none does
  total_force_n: number | null; // of the joints that slide; null if none does
  effort_limits: [number, number][]; // one per joint
}

export interface TaskInfo {
  signal: string;
  speed_m_per_s: number;
  distance_limit_m: number;
  rest_s: number;
  control_period_s: number;
  load_kg: number;
  ik_bug: boolean;
}

export interface Segment {
  first_step: number;
  steps: number;
  window_start: number; // the first measured step, counted from the beginning of the segment
  distance_m: number;
  duration_s: number; // t_m
}

// The motion of a design on a test case. Row k is the state at the end of control period k.
export interface Motion {
  design: string; // DesignInfo.id
  status: string; // "ok", "diverged", ...
  reason: string;
  steps: number; // until the motion ended
  mean_error_m: number | null;
  point_error_m: number[]; // from point 1 until the motion ended
  q: Packed; // steps x joints, rad or m
  effort: Packed; // steps x joints, N m or N
  error_m: Packed; // steps: |tip - target|
}

export interface ReplayCase {
  id: string; // "test/2:17"
  label: string; // "test/2, case 17: the worst of 500"
  set: string;
  number: number;
  points_m: [number, number, number][]; // the start, then the trajectory points; empty for a recorded motion, which has no target
  segments: Segment[]; // one per point after the start
  steps: number;
  target_m: Packed; // steps x 3
  target_q: Packed; // steps x joints
  start_q: number[];
  motions: Motion[];
}

export interface ReplaySet {
  id: string;
  title: string;
  robot: number; // index into PageBase.robots; the load is one of its shapes
  task: TaskInfo;
  designs: DesignInfo[];
  cases: ReplayCase[]; // the first one is shown first
}

// The average error of each trajectory point over the cases of a set. All cases have the same
// distances.
export interface DistanceResponse {
  id: string; // "distance-response" or "fig-6.4"
  title: string;
  thesis: string; // "Fig. 6.4" or ""
  remark: string; // whole sentences, or ""
  distances_m: number[];
  counted: boolean[]; // whether the point counts in the error of a case
  series: ResponseSeries[];
}

export interface ResponseSeries {
  name: string;
  cases: number; // that have a number
  failures: number;
  mean_m: (number | null)[]; // one per point
  standard_error_m: (number | null)[]; // of the mean
  overall_mean_m: number | null;
  overall_median_m: number | null;
  published_mean_m: number | null;
  command: string; // that makes this series again; "" if there is none
}

export interface SignalCurve {
  name: string; // "Complex"
  time_s: number[];
  distance_m: number[];
  speed_m_per_s: number[];
  acceleration_m_per_s2: number[];
}

// The reference signals over one move, and the slowing down of short moves.
export interface Signals {
  distance_m: number; // of the move
  speed_m_per_s: number; // average
  rest_s: number;
  used: string; // the name of the signal that the problem uses; "" for none
  curves: SignalCurve[];
  reduction: { distance_m: number[]; speed_m_per_s: number[]; limit_m: number };
}

export interface Sweep {
  parameter: string; // "task.speed_m_per_s"
  quantity: Quantity; // of the abscissa
  values: number[];
  nominal: number | null; // the value for which the design was tuned
  cases: number;
  engine: string;
  command: string;
  series: {
    name: string;
    mean_m: (number | null)[];
    standard_error_m: (number | null)[];
    median_m: (number | null)[];
    failures: number[];
  }[];
}
