// The types of the page's data: the JSON that the program writes (src/report/page/). All values have
// SI units; the figures convert them. A number that does not exist (a case without a result, an
// infinite value) is null. The keys are those of the JSON.
import type { ReplaySet, Robot } from './data/arm';
import type { ComparisonData } from './data/comparison';
import type { ReproductionData } from './data/reproduction';
import type { RunData } from './data/run';
import type { StudyData } from './data/study';

export type * from './data/arm';
export type * from './data/comparison';
export type * from './data/identification';
export type * from './data/reproduction';
export type * from './data/run';
export type * from './data/study';

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

export type PageData = RunData | StudyData | ReproductionData | ComparisonData;
