// The types of the page's data: the JSON that the program writes (src/report/page/). All values have
// SI units; the figures convert them. A number that does not exist (a case without a result, an
// infinite value) is null. The keys are those of the JSON.

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
  own_unit?: boolean; // shown in this unit, as the problem has no arm; lengths of an arm are shown in mm
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
  format: 2; // kPageFormat
  title: string;
  subtitle: string;
  program: Program;
  folder: string;
  command: string; // the shell command that made the run or study
  finished: boolean;
  progress: { done: number; total: number; unit: string } | null; // null if it is finished
  watched: Watched | null; // null unless `armwright watch` serves the page
  notes: string[]; // whole sentences: missing parts of the page with their reasons, and warnings
  facts: Fact[]; // about the run or study, in the order to show
  robots: Robot[];
  replays: ReplaySet[];
}

// The progress at the time when `armwright watch` made the page.
export interface Watched {
  simulations: number | null; // cases simulated so far; null for a reproduction
  per_second: number | null; // simulations in the last minute; null while it is unknown
  left_s: number | null; // estimated; null while it is unknown
  running: { cell: string; process: string; done: number | null; total: number }[]; // cases of the cells that are running
  failed_evaluations: number; // candidates with a simulation that failed
  failures: { where: string; state: string; reason: string }[]; // cells, then the newest candidates
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
  total_torque_n_m: number | null;
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
  points_m: [number, number, number][]; // the start, then the trajectory points
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

// ---------------------------------------------------------------- a run

export interface RunData extends PageBase {
  kind: 'run';
  problem: string;
  optimizer: string;
  quantity: Quantity; // the minimised objective, or the weighted sum of several
  logarithmic: boolean; // the quantity is itself a logarithm
  training: Training;
  variables: VariableHistory[];
  test: TestErrors | null; // null before the run has ended
  front: RunFront | null; // null if there is only one objective
  requirements: RequirementLight[]; // for the winner on the test set; empty without a winner
  headline: Headline;
  limits: WinnerLimit[]; // the winner's constraints on the test set; empty without a winner
  metrics: WinnerMetric[]; // the winner's on the test set; empty for an arm
  failure_reasons: FailureReason[]; // of training evaluations, the most frequent first
  record: string | null; // winner-record.csv: signals of the winner on the first test case
  files: WinnerFile[]; // that this case left
  arm: ArmEvidence | null; // null if the problem is not an arm
}

export interface WinnerLimit {
  quantity: Quantity;
  limit: number;
  value: number | null; // null if no case has a number
  is_met: boolean | null;
}

export interface WinnerMetric {
  quantity: Quantity;
  value: number | null;
}

export interface FailureReason {
  reason: string;
  count: number;
}

export interface WinnerFile {
  name: string;
  bytes: number;
  type: string; // by its content: "image/png", "image/jpeg", "image/svg+xml", "text/csv", or "" for others
  text: string | null; // of a CSV file
  base64: string; // empty for a CSV file
}

export type VariableType = 'real' | 'integer' | 'category';

// What the run recorded of its result and effort. The fields after `cases` are null without a winner.
export interface Headline {
  started: string; // "2026-01-31T12:00:00Z", or "" if it is not recorded
  evaluations: number; // of training
  cases: number; // simulated in training
  value: number | null; // the winner's on the test set: an arm's mean error, or the objective
  quantity: Quantity | null; // of `value`
  failures: number | null; // test cases that an arm failed
  test_cases: number | null;
  total_torque_n_m: number | null;
  times: RunTimes | null; // null if the run has none, as runs of version 1.0
}

// How long a run took, over the lives of its process that were not killed.
export interface RunTimes {
  wall_s: number;
  cpu_s: number | null; // null if other processes simulated cases
  lives: number;
}

// A quantity that must not exceed a limit on any test case, and the result.
export interface RequirementLight {
  quantity: Quantity;
  limit: number;
  value: number | null; // of the worst case
  grade: 'met' | 'tight' | 'missed' | 'unknown'; // tight: met, within 10 % of the limit
  binds: boolean; // nearest to its limit of all requirements, or furthest above it
  is_constraint: boolean;
}

// The history by generations, or by blocks of consecutive evaluations if the optimizer has no
// generations.
export interface Training {
  unit: 'generation' | 'evaluations';
  schedule: string; // "fresh:1", "fixed:5", "coevolution:10"
  budget: number; // cases
  index: number[]; // the generation, or the number of the last evaluation of the block
  cases: number[]; // spent of the budget at the end of each generation or block
  best: (number | null)[];
  mean: (number | null)[];
  worst: (number | null)[];
  failed: number[]; // evaluations without a number
  incumbents: Incumbents;
}

// The incumbents of the run and their values on the test set.
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
  type: VariableType;
  choices: string[]; // the words of a category; its values are their places, from 0
  lower: number;
  upper: number;
  start: number;
  logarithmic: boolean;
  winner: number | null;
  best: (number | null)[]; // the value of the best design of each generation or block
  q1: (number | null)[];
  median: (number | null)[];
  q3: (number | null)[];
}

export interface TestErrors {
  set: string;
  quantity: Quantity; // of the errors
  engine: string;
  failure_error: number | null; // a case with a larger error has failed
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
  // One row per number of the design. The values are in the order of `designs`.
  parameters: { name: string; unit: string; is_variable: boolean; at_bound: string; values: (number | null)[] }[];
  // The results of each design on the test set, and the published values.
  results: {
    design: string; // the id of one of `designs`
    source: string; // "thesis, Table A.5", or "" if its file names none
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
  health: Health | null; // null without a winner and if nothing was simulated
}

// "watch" is worth a look, "bad" needs a remedy.
export type HealthGrade = 'good' | 'watch' | 'bad';

// How calmly the winner moves. src/report/evidence/health.hpp defines the measures. Saturation and
// failures are those of the whole test set; ripple, efforts and moves are those of one case.
export interface Health {
  set: string;
  cases: number; // of the set
  case: string; // "test/2:17": the median case by the winner's error
  failures: number;
  failing: HealthGrade;
  ripple_floor_hz: number; // only faster oscillations count
  // The shares from which "watch" and "bad" begin, and the distance to a bound up to which a variable
  // is near.
  limits: { saturation: [number, number]; ripple: [number, number]; bound: number };
  joints: JointHealth[];
  moves: MoveHealth | null; // null if the case has no moves
  bounds: {
    grade: HealthGrade;
    near: number; // variables near a bound
    nearest: { name: string; bound: 'lower' | 'upper'; distance: number }[]; // the near ones or the nearest one; shares of the range
  };
}

// A measure that cannot be computed is null, and so is its grade.
export interface JointHealth {
  name: string;
  unit: string; // of efforts
  saturated_share: number | null; // of the time
  saturation: HealthGrade | null;
  ripple_rms: number | null;
  ripple_share: number | null; // of the larger effort limit
  ripple_hz: number | null; // the dominant frequency
  ripple: HealthGrade | null;
  used_share: number | null; // the largest effort, as a share of the limit on its side
}

// The response of the tip to the moves that count (src/sim/tracking/response.hpp).
export interface MoveHealth {
  count: number;
  overshoot_median: number; // shares of the move
  overshoot_largest: number;
  settling_median_s: number;
  settling_largest_s: number;
  settling_band: number; // share of the move
  unsettled: number; // moves that end before the tip stays in the band; their time is the whole time after the arrival
}

// ---------------------------------------------------------------- a comparison

export interface StudyData extends PageBase {
  kind: 'study';
  verdict: string[]; // paragraphs
  optimizers: { label: string; name: string }[]; // in the order of the plan; all lists with one item per optimizer have this order
  replicates: number;
  fewest_replicates: number | null; // with fewer no pair of optimizers can be decided on a problem; null if there is no pair
  budget: number;
  reference: string; // times to fixed targets are divided by those of this optimizer; may be empty
  problems: StudyProblem[];
  overall: StudyOverall | null; // null while no problem is complete
}

export interface StudyCell {
  replicate: number;
  value: number | null; // null: infinite
  cases: number;
  evaluations: number;
  wall_s: number | null; // null if it was not recorded, as in studies of version 1.0
  cpu_s: number | null; // null also if other processes simulated cases
  failure: string; // of the optimizer
  failures: number; // failed test cases
  x: number[]; // the winner, 9 significant digits; empty if there is none
  folder: string;
  command: string; // armwright rerun STUDY CELL
}

export interface StudyOptimizerResult {
  cells: StudyCell[]; // the cells that have ended, by replicate
  successes: number; // runs within the problem's resolution of the optimum, or with any value if it is unknown
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
  median_rank: number | null; // of the median; equal medians share their ranks; null while cells are missing
  anytime_area: number | null;
  cases: number | null; // median
  running_times: { target: number; reached: number; expected: number | null; interval: [number | null, number | null] }[];
  // The times to each fixed target of the problem. The ratio is to the time of the reference
  // optimizer.
  target_times: {
    reached: number;
    kept: number; // runs whose winner meets the target
    expected: number | null;
    interval: [number | null, number | null];
    ratio: number | null;
    ratio_interval: [number | null, number | null];
  }[];
  curve: { q1: (number | null)[]; median: (number | null)[]; q3: (number | null)[] }; // at the checkpoints
  ecdf: number[]; // at the checkpoints
  final_check: { engine: string; value: number | null; failures: number; cases: number; replicate: number } | null;
}

// The F statistic of Iman and Davenport. It is null if it is infinite, because all rank alike; p is
// then that of chi-squared.
export interface Friedman {
  statistic: number | null;
  p: number;
}

export interface StudyPair {
  a: number; // index of the optimizer that is better by the ranks of the pairs
  b: number;
  p: number;
  p_holm: number;
  a12: number; // the probability that a run of a is better than a run of b
  significant: boolean;
  wins: number; // replicates in which a is better
  ties: number;
  losses: number;
}

export interface StudyProblem {
  label: string;
  title: string;
  quantity: Quantity;
  has_front: boolean;
  resolution: number; // differences up to it count as none
  optimum: number | null; // null if it is unknown
  best_known: number | null; // the optimum if it is known
  start: number | null;
  exact_times: boolean; // running times come from every incumbent, not only from the checkpoints
  checkpoints: number[];
  targets: number[];
  fixed_targets: string[]; // in words
  variables: {
    name: string;
    unit: string;
    type: VariableType;
    choices: string[];
    lower: number;
    upper: number;
    start: number;
    logarithmic: boolean;
  }[];
  results: StudyOptimizerResult[]; // one per optimizer
  friedman: Friedman | null;
  pairs: StudyPair[];
  order: number[]; // best first
  missing: number; // cells that have not ended
  front: StudyFront | null;
}

export interface StudyFront {
  objectives: Quantity[];
  reference_point: number[];
  // One item per optimizer: the points that no point of their own replicate dominates (at most 200 of
  // each replicate), and, with two objectives, the areas that shares of the replicates attain (0.25,
  // 0.5 and 0.75). 9 significant digits.
  optimizers: { points: { values: number[]; replicate: number }[]; attainment: { share: number; points: number[][] }[] }[];
}

export interface StudyOverall {
  mean_ranks: number[]; // one per optimizer
  rank_intervals: [number, number][] | null; // 95 %, by resampling of problems; null with fewer than 6 problems
  friedman: Friedman | null;
  pairs: StudyPair[];
  // The largest sets of optimizers, by index, in which no two optimizers are told apart. An optimizer
  // may be in several sets, and the members of a set need not be neighbours by rank. Empty with one
  // problem, because no test is done then.
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
    standard_error_m: number | null; // of the mean
    failures: number;
    torque_n_m: number;
    reason: string; // why our numbers may differ from the published ones; "" if it is not known
    command: string;
  }[];
  // The designs that were optimized again, because the thesis does not give them.
  runs: {
    name: string;
    problem: string;
    cases: number;
    mean_m: number | null;
    torque_n_m: number;
    published_torque_n_m: number | null;
    reason: string; // as in rows
    folder: string;
    command: string;
  }[];
  responses: DistanceResponse[];
  signals: Signals;
  sweep: Sweep;
  // Fig. 6.5-6.8: the momentary error of each design on the training case of generation 1.
  momentary: { name: string; replay: string; design: string; case: string }[];
}

// ---------------------------------------------------------------- two runs or two studies, A and B

export interface ComparisonData extends PageBase {
  kind: 'comparison';
  settings: ComparedSetting[]; // all that decide the course or the result, by name
  runs: ComparedRuns | null; // null for studies
  studies: ComparedStudies | null; // null for runs
}

export interface ComparedSetting {
  name: string; // "problem.task.speed_m_per_s"
  a: string | null; // null if A does not have it
  b: string | null;
  basis: string | null; // the part of the comparison's basis ("the engine"); null if results do not depend on it
}

// The pages of both runs without replays. The replay of the comparison has both winners on the cases
// that both have.
export interface ComparedRuns {
  a: RunData;
  b: RunData;
  same_cases: boolean; // both winners were tested on the same cases
  paired: PairedErrors | null; // null without common test cases
}

// The winners' errors case by case. A win is a case in which A is better.
export interface PairedErrors {
  cases: number;
  wins: number;
  ties: number;
  losses: number;
  p: number; // of the signed-rank test
  a12: number; // the probability that a case of A is better than a case of B
  better: 'a' | 'b' | null; // by the test; null if it does not tell them apart
}

export interface ComparedStudies {
  a: StudyData;
  b: StudyData;
  cells: ComparedCell[]; // the problems and optimizers that both have
}

// One optimizer on one problem in both studies. p is null if `untested` says why. A win is a replicate
// in which A is better.
export interface ComparedCell {
  problem: string;
  optimizer: string;
  quantity: Quantity;
  a: ComparedSide;
  b: ComparedSide;
  pairs: number;
  wins: number;
  ties: number;
  losses: number;
  a12: number | null; // the probability that a run of A is better than a run of B; null without runs or if settings of the problem differ
  p: number | null; // of the signed-rank test
  p_holm: number | null; // after Holm's correction over all cells
  better: 'a' | 'b' | null; // null if the test does not tell them apart
  untested: string | null; // why there is no test: "the seed differs"
}

export interface ComparedSide {
  runs: number; // that have ended
  q1: number | null;
  median: number | null;
  q3: number | null;
}

export type PageData = RunData | StudyData | ReproductionData | ComparisonData;
