// The data of the page that compares two runs or two studies, A and B.
import type { PageBase, Quantity } from '../data';
import type { RunData } from './run';
import type { StudyData } from './study';

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
