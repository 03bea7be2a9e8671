// The data of the page of the repeated thesis.
import type { PageBase } from '../data';
import type { DistanceResponse, Signals, Sweep } from './arm';

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
