// What an identification found: the robot's parameters, and the efforts of the models beside those
// recorded. A number that does not exist is null.
import type { Packed } from '../data';

export interface Identification {
  robot: string;
  doubts: string[]; // whole sentences without a point, the gravest first
  undetermined: string[]; // likewise: what the motions cannot tell
  parameters: FittedParameter[];
  correlations: { first: string; second: string; value: number | null }[]; // pairs above 0.9
  fitted: FitSet;
  held_back: FitSet | null; // null if no log was held back
  motions: RecordedMotion[]; // those that were fitted, then those held back
}

export interface FittedParameter {
  name: string;
  unit: string;
  before: number | null; // the robot's own value
  start: number | null; // of the search: that of linear least squares
  value: number | null;
  standard_error: number | null;
  lower: number | null; // of the 95 % interval
  upper: number | null;
  determined: boolean;
  at_bound: boolean;
}

// Errors are means over the joints of rms / deviation.
export interface FitSet {
  logs: string[];
  joints: JointFit[];
  error_before: number | null;
  error_after: number | null;
}

export interface JointFit {
  joint: string;
  unit: string;
  deviation: number | null; // of the recorded effort
  rms_before: number | null;
  rms_after: number | null;
  whiteness_p: number | null; // below 0.05 the residuals are not white
  independent_s: number | null; // after which a residual tells something new
}

// Efforts of rows x joints. Row k is at the time k period_s.
export interface RecordedMotion {
  id: string; // of the case in the replay, if there is one
  log: string;
  held_back: boolean;
  period_s: number;
  recorded: Packed;
  before: Packed; // of the model with the robot's own parameters
  after: Packed; // of the model with the fitted ones
}
