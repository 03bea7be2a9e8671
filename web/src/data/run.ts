// The data of the page of a run.
import type { PageBase, Quantity } from '../data';
import type { DesignInfo, DistanceResponse, Signals, Sweep } from './arm';
import type { Identification } from './identification';

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
  importance?: Importance | null; // null before the end of the run; pages of older versions have none
  failure_reasons: FailureReason[]; // of training evaluations, the most frequent first
  record: string | null; // winner-record.csv: signals of the winner on the first test case
  record_limits: Record<string, number> | null; // of a planned motion: the limits of signals, by their names
  files: WinnerFile[]; // that this case left
  identification?: Identification | null; // null for other runs; pages of version 1.0 have none
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

// Which variables matter: Sobol indices (src/study/analysis/importance.hpp).
export interface Importance {
  objective: Quantity;
  scale: 'plain' | 'logarithm' | 'ranks';
  value: string; // the words for what is explained: "the logarithm of mean error"
  evaluations: number;
  left_out: number; // evaluations that failed or lost a race
  parts: ImportancePart[];
  notes: string[]; // whole sentences
}

export interface ImportancePart {
  region: 'run' | 'winner' | 'design';
  words: string; // "near the winner, within 10 % of each variable's range"
  half_width: number | null;
  points: number;
  explained: number | null; // the share of the variance that the model explains, cross-validated
  terms: 'linear' | 'squares' | 'products' | null;
  judgement: string; // a sentence: how far the numbers can be trusted
  variables: { name: string; first: SobolIndex; total: SobolIndex }[];
}

export interface SobolIndex {
  value: number;
  lower: number; // of the 95 % interval
  upper: number;
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

// The recorded result and effort of a run. The fields after `cases` are null without a winner.
export interface Headline {
  faults: string[]; // why nobody should use the winner as it is; empty if there is no reason
  started: string; // "2026-01-31T12:00:00Z", or "" if it is not recorded
  evaluations: number; // of training
  cases: number; // simulated in training
  value: number | null; // the winner's on the test set: an arm's mean error at rest, or the objective
  quantity: Quantity | null; // of `value`
  failures: number | null; // test cases that an arm failed
  test_cases: number | null;
  total_torque_n_m: number | null; // of the joints that turn; null if none does
  total_force_n: number | null; // of the joints that slide; null if none does
  motion: MotionErrors | null; // null if it was not measured, as by version 1.0
  times: RunTimes | null; // null if the run has none, as runs of version 1.0
}

// The winner's distances from the moving target on the test set (docs/objectives.md).
export interface MotionErrors {
  error_while_moving_rms_m: number;
  error_while_moving_peak_m: number;
  error_after_start_up_m: number | null; // null for a continuous path
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

export interface DesignFile {
  name: string; // "front-12.toml"
  text: string;
  command: string; // that evaluates the saved file; may be empty
}

export interface RunFront {
  objectives: Quantity[];
  // `evaluation` counts from 0. `file` holds the design for armwright evaluate; null if the problem
  // could not be rebuilt.
  points: { values: number[]; on_front: boolean; x: number[]; evaluation: number; file: DesignFile | null }[];
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
    total_torque_n_m: number | null;
    total_force_n: number | null;
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
  // The constraints that the winner violates on the test set; null if the problem has none.
  constraints: { grade: HealthGrade | null; violated: string[] } | null;
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
  check: WinnerCheck | null; // null if the winner was not checked under other conditions
}

// How the winner does in settings that differ from its own in one condition each
// (src/study/verification/winner_check.hpp).
export interface WinnerCheck {
  cases: number; // of each setting, the first ones of the test set
  own_m: number | null; // the mean error in its own setting
  limit_m: number; // up to which a mean error works
  settings: CheckedSetting[];
}

export interface CheckedSetting {
  name: string; // "2 physics steps per control period"
  grade: HealthGrade | null; // null: it was not simulated
  outcome: string; // "fails in 10 of 10 cases"
  mean_m: number | null;
  reason: string; // why it or a case of it was not simulated
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
