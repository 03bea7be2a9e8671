// What the page is fed with: JSON that the program writes (src/report/page/). SI units throughout;
// the figures convert. A number that does not exist (a case without result, an infinite value) is
// null. Keys are those of the JSON.

// An array of numbers, little-endian, in base64.
export interface Packed {
  f32?: string;
  // value = offset + scale * integer
  i16?: string;
  u32?: string;
  scale?: number;
  offset?: number;
}

export interface Quantity {
  name: string;
  unit: string;
}

export interface Fact {
  label: string;
  value: string;
}

export interface Program {
  version: string;
  commit: string;
}

export interface PageBase {
  format: 1;
  title: string;
  subtitle: string;
  program: Program;
  folder: string;
  command: string; // what made the run or study; a shell command
  finished: boolean;
  progress: { done: number; total: number; unit: string } | null; // of what is unfinished
  notes: string[]; // what the page lacks and why, what to beware of; whole sentences
  facts: Fact[]; // what it is, in the order to show
  robots: Robot[];
  replays: ReplaySet[];
}

// ---------------------------------------------------------------- the arm

export interface Pose {
  position: [number, number, number];
  quaternion: [number, number, number, number]; // x y z w
}

export interface Shape {
  kind: 'box' | 'cylinder' | 'sphere' | 'mesh';
  size: [number, number, number]; // box: edges; cylinder: radius, length along z, 0; sphere: radius, 0, 0; mesh: scale
  mesh: number | null; // index into Robot.meshes
  pose: Pose; // in the body's frame
  rgba: [number, number, number, number];
}

export interface Body {
  name: string;
  shapes: Shape[];
}

export interface RobotJoint {
  name: string;
  kind: 'revolute' | 'prismatic';
  origin: Pose; // in the parent body's frame, at position 0
  axis: [number, number, number];
  lower: number | null; // null: none
  upper: number | null;
}

export interface Mesh {
  positions: Packed; // 3 a vertex
  indices: Packed; // 3 a triangle
}

export interface Robot {
  name: string;
  bodies: Body[]; // the base, then the one that each joint moves
  joints: RobotJoint[];
  tip: Pose; // in the last body's frame
  meshes: Mesh[];
}

export interface DesignInfo {
  id: string;
  name: string; // "winner", "base controllers", "thesis, Table A.5"
  total_torque_n_m: number | null;
  effort_limits: [number, number][]; // one a joint
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
  window_start: number; // first step, within the segment, that is measured
  distance_m: number;
  duration_s: number; // t_m
}

// A design's motion on a test case; row k is the state at the end of control period k.
export interface Motion {
  design: string; // DesignInfo.id
  status: string; // "ok", "diverged", ...
  reason: string;
  steps: number; // as far as it went
  mean_error_m: number | null;
  point_error_m: number[]; // as far as it went, from point 1
  q: Packed; // steps x joints, rad or m
  effort: Packed; // steps x joints, N m or N
  error_m: Packed; // steps: |tip - target|
}

export interface ReplayCase {
  id: string; // "test/2:17"
  label: string; // "test/2, case 17: the worst of 500"
  set: string;
  number: number;
  points_m: [number, number, number][]; // the start, then the trajectory points
  segments: Segment[]; // one a point after the start
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
  cases: ReplayCase[]; // the first is the one to show first
}

// Average error of each trajectory point over the cases of a set, which have the same distances.
export interface DistanceResponse {
  id: string; // "distance-response" or "fig-6.4"
  title: string;
  thesis: string; // "Fig. 6.4" or ""
  remark: string; // whole sentences, or ""
  distances_m: number[];
  counted: boolean[]; // whether the point counts in a case's error
  series: ResponseSeries[];
}

export interface ResponseSeries {
  name: string;
  cases: number; // with a number
  failures: number;
  mean_m: (number | null)[]; // one a point
  standard_error_m: (number | null)[]; // of the mean
  overall_mean_m: number | null;
  overall_median_m: number | null;
  published_mean_m: number | null;
  command: string; // that makes this series anew; "" if there is none
}

export interface SignalCurve {
  name: string; // "Complex"
  time_s: number[];
  distance_m: number[];
  speed_m_per_s: number[];
  acceleration_m_per_s2: number[];
}

// Reference signals over one move, and how short moves are slowed down.
export interface Signals {
  distance_m: number; // of the move
  speed_m_per_s: number; // average
  rest_s: number;
  used: string; // the name of the one that the problem uses; "" for none
  curves: SignalCurve[];
  reduction: { distance_m: number[]; speed_m_per_s: number[]; limit_m: number };
}

export interface Sweep {
  parameter: string; // "task.speed_m_per_s"
  quantity: Quantity; // of the abscissa
  values: number[];
  nominal: number | null; // the value that the design was tuned for
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

// ---------------------------------------------------------------- a run

export interface RunData extends PageBase {
  kind: 'run';
  problem: string;
  optimizer: string;
  quantity: Quantity; // the objective that is minimised, or the weighted sum of several
  logarithmic: boolean; // the quantity is itself a logarithm
  training: Training;
  variables: VariableHistory[];
  test: TestErrors | null; // nothing before the run has ended
  front: RunFront | null; // of several objectives
  requirements: RequirementLight[]; // of the winner on the test set; empty before there is one
  arm: ArmEvidence | null; // of an arm's problem
}

// A quantity that shall not exceed a limit on any test case, and whether it does.
export interface RequirementLight {
  quantity: Quantity;
  limit: number;
  value: number | null; // of the worst case
  grade: 'met' | 'tight' | 'missed' | 'unknown'; // tight: met, within 10 % of the limit
  binds: boolean; // nearest to its limit of all, or furthest above it
  is_constraint: boolean;
}

// Generations, or of an optimizer without them blocks of consecutive evaluations.
export interface Training {
  unit: 'generation' | 'evaluations';
  schedule: string; // "fresh:1", "fixed:5", "coevolution:10"
  budget: number; // cases
  index: number[]; // generation, or number of the block's last evaluation
  cases: number[]; // of the budget, at its end
  best: (number | null)[];
  mean: (number | null)[];
  worst: (number | null)[];
  failed: number[]; // evaluations without number
  incumbents: Incumbents;
}

// The best designs known on the way, on the test set.
export interface Incumbents {
  index: number[]; // as in Training
  cases: number[];
  training: (number | null)[];
  test: (number | null)[];
  test_set: string;
  test_cases: number;
  engine: string;
}

export interface VariableHistory {
  name: string; // "joint_2.p"
  unit: string;
  lower: number;
  upper: number;
  start: number;
  logarithmic: boolean;
  winner: number | null;
  best: (number | null)[]; // of each generation or block: that of its best
  q1: (number | null)[];
  median: (number | null)[];
  q3: (number | null)[];
}

export interface TestErrors {
  set: string;
  quantity: Quantity; // of the errors
  engine: string;
  failure_error: number | null; // above it a case has failed
  designs: {
    name: string;
    errors: (number | null)[];
    failures: { case: number; error: number | null; reason: string; command: string }[];
  }[];
}

export interface RunFront {
  objectives: Quantity[];
  points: { values: number[]; on_front: boolean; x: number[] }[];
  winner: number | null; // index
}

export interface ArmEvidence {
  designs: DesignInfo[];
  // A row a number of the design; the values are in the order of `designs`.
  parameters: { name: string; unit: string; is_variable: boolean; at_bound: string; values: (number | null)[] }[];
  // Of each design on the test set, beside what is published.
  results: {
    design: string;
    mean_m: number | null;
    median_m: number | null;
    p95_m: number | null;
    worst_m: number | null;
    failures: number;
    cases: number;
    total_torque_n_m: number;
    published_mean_m: number | null;
    published_torque_n_m: number | null;
    where: string;
  }[];
  response: DistanceResponse;
  signals: Signals;
  sweep: Sweep | null;
}

// ---------------------------------------------------------------- a comparison

export interface StudyData extends PageBase {
  kind: 'study';
  verdict: string[]; // paragraphs
  optimizers: { label: string; name: string }[]; // in the plan's order; all lists "one an optimizer" follow it
  replicates: number;
  budget: number;
  reference: string; // the optimizer that times to fixed targets are divided by; may be empty
  problems: StudyProblem[];
  overall: StudyOverall | null; // of at least one complete problem
}

export interface StudyCell {
  replicate: number;
  value: number | null; // null: infinite
  cases: number;
  evaluations: number;
  seconds: number | null; // CPU or wall time where it was recorded: so far no run does
  failure: string; // of the optimizer
  failures: number; // test cases that failed
  x: number[]; // the winner, 9 significant digits; empty if there is none
  folder: string;
  command: string; // armwright rerun STUDY CELL
}

export interface StudyOptimizerResult {
  cells: StudyCell[]; // those that have ended, by replicate
  infinite: number;
  infeasible: number;
  failed: number;
  min: number | null;
  q1: number | null;
  median: number | null;
  q3: number | null;
  max: number | null;
  median_interval: [number | null, number | null];
  mean_rank: number | null; // null while cells of the problem are missing
  anytime_area: number | null;
  cases: number | null; // median
  running_times: { target: number; reached: number; expected: number | null; interval: [number | null, number | null] }[];
  // To each of the problem's fixed targets; the ratio is to the study's reference.
  target_times: {
    reached: number;
    kept: number; // runs whose winner meets it
    expected: number | null;
    interval: [number | null, number | null];
    ratio: number | null;
    ratio_interval: [number | null, number | null];
  }[];
  curve: { q1: (number | null)[]; median: (number | null)[]; q3: (number | null)[] }; // at the checkpoints
  ecdf: number[]; // likewise
  final_check: { engine: string; value: number | null; failures: number; cases: number; replicate: number } | null;
}

// Iman and Davenport's F; null if it is infinite, as all rank alike: p is chi-squared's then.
export interface Friedman {
  statistic: number | null;
  p: number;
}

export interface StudyPair {
  a: number; // index of the optimizer; a's median is not worse than b's
  b: number;
  p: number;
  p_holm: number;
  a12: number; // that a run of a is better than one of b
  significant: boolean;
  wins: number; // of a
  ties: number;
  losses: number;
}

export interface StudyProblem {
  label: string;
  title: string;
  quantity: Quantity;
  has_front: boolean;
  best_known: number | null;
  start: number | null;
  checkpoints: number[];
  targets: number[];
  fixed_targets: string[]; // in words
  variables: { name: string; unit: string; lower: number; upper: number; start: number; logarithmic: boolean }[];
  results: StudyOptimizerResult[]; // one an optimizer
  friedman: Friedman | null;
  pairs: StudyPair[];
  order: number[]; // best first
  missing: number; // cells that have not ended
  front: StudyFront | null;
}

export interface StudyFront {
  objectives: Quantity[];
  reference_point: number[];
  // One an optimizer: the points that none of their own replicate dominates (at most 200 of each), and
  // what shares of the replicates attain (of two objectives; 0.25, 0.5 and 0.75). 9 significant digits.
  optimizers: { points: { values: number[]; replicate: number }[]; attainment: { share: number; points: number[][] }[] }[];
}

export interface StudyOverall {
  mean_ranks: number[]; // one an optimizer
  rank_intervals: [number, number][] | null; // 95 %, problems resampled; null of fewer than 6 problems
  friedman: Friedman | null;
  pairs: StudyPair[];
  // The largest sets of optimizers, by index, none of which is told apart from another of the set; one
  // may be in several, and a set need not be neighbours by rank. Empty of one problem, where nothing is tested.
  cliques: number[][];
  kappas: number[];
  data_profiles: { tolerance: number; shares: number[][] }[];
  alphas: number[];
  performance_profiles: { tolerance: number; shares: number[][] }[];
}

// ---------------------------------------------------------------- the thesis repeated

export interface ReproductionData extends PageBase {
  kind: 'reproduction';
  rows: {
    label: string;
    design: string;
    problem: string;
    overrides: string[];
    where: string;
    published_error_m: number | null;
    published_torque_n_m: number | null;
    cases: number;
    mean_m: number | null;
    median_m: number | null;
    p95_m: number | null;
    worst_m: number | null;
    failures: number;
    torque_n_m: number;
    command: string;
  }[];
  // What was optimized anew, as the source gives no design.
  runs: {
    name: string;
    problem: string;
    cases: number;
    mean_m: number | null;
    torque_n_m: number;
    published_torque_n_m: number | null;
    folder: string;
    command: string;
  }[];
  responses: DistanceResponse[];
  signals: Signals;
  sweep: Sweep;
  // Fig. 6.5-6.8: the momentary error of each on the training case of generation 1.
  momentary: { name: string; replay: string; design: string; case: string }[];
}

export type PageData = RunData | StudyData | ReproductionData;
