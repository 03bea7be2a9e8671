// The data of the page of a study.
import type { PageBase, Quantity } from '../data';
import type { VariableType } from './run';

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
  // igd_plus is the median over the replicates; null without a front.
  optimizers: {
    points: { values: number[]; replicate: number }[];
    igd_plus: number | null;
    attainment: { share: number; points: number[][] }[];
  }[];
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
