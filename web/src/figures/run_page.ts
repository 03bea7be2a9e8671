// The page of one run.
import type { Identification, RunData } from '../data';
import type { Figure, Item, Tab } from '../model';
import { make_design_table, make_results_table } from './design_table';
import { make_response_figure } from './distance_response';
import { make_health_item, make_tiles_item } from './health';
import {
  make_correlation_table,
  make_doubts_item,
  make_effort_figure,
  make_fit_table,
  make_identification_headline,
  make_interval_figure,
  make_parameter_table,
} from './identification';
import { make_importance_items } from './importance';
import { make_joint_figures, make_saturation_table } from './joints';
import { make_momentary_figure } from './momentary';
import { make_requirement_table } from './requirement_table';
import { make_front_figure } from './run_front';
import { make_reduction_figure, make_signal_figures } from './signals';
import { make_sweep_figure } from './sweep';
import { make_errors_figure, make_failures_table } from './test_errors';
import { has_training, make_fitness_figure } from './training';
import { make_case_figure } from './trajectory';
import { make_variables_figure } from './variables';
import { make_limit_table, make_metric_table, make_reason_table, make_record_items, make_variable_table } from './winner';

function is_there<T>(item: T | null): item is T {
  return item !== null;
}

// Returns the tabs that have items. A tab without items is left out.
export function keep_filled(tabs: { id: string; title: string; items: (Item | null)[] }[]): Tab[] {
  return tabs.map((tab) => ({ id: tab.id, title: tab.title, items: tab.items.filter(is_there) })).filter((tab) => tab.items.length > 0);
}

// Returns the same figure for the overview, with its own id.
function make_half(figure: Figure, id: string): Figure {
  return { ...figure, id, width: 'half', height: 360 };
}

// An identification has no design to tune, so its page has other tabs than that of another run.
function make_identification_tabs(data: RunData, found: Identification): Tab[] {
  return keep_filled([
    {
      id: 'overview',
      title: 'Overview',
      items: [
        make_doubts_item(found),
        make_identification_headline(data, found),
        make_fit_table(found),
        data.facts.length > 0 ? { kind: 'facts', id: 'facts', title: 'About', facts: data.facts } : null,
      ],
    },
    {
      id: 'motion',
      title: 'Motion',
      items: [
        data.replays.length > 0 ? { kind: 'replay', id: 'replay', title: 'The arm as recorded', sets: data.replays } : null,
        make_effort_figure(found),
      ],
    },
    {
      id: 'parameters',
      title: 'Parameters',
      items: [make_parameter_table(found), make_interval_figure(found), make_correlation_table(found)],
    },
    {
      id: 'search',
      title: 'Search',
      items: [has_training(data) ? make_fitness_figure(data) : null, make_variables_figure(data), make_reason_table(data)],
    },
  ]);
}

export function make_run_tabs(data: RunData): Tab[] {
  if (data.identification) {
    return make_identification_tabs(data, data.identification);
  }
  const { arm, test } = data;
  const set = data.record_limits === null ? data.replays[0] : undefined; // the figures over time share their cursor with this replay set
  const robot = set ? data.robots[set.robot] : undefined;
  const fitness = has_training(data) ? make_fitness_figure(data) : null;
  const has_response = arm !== null && arm.response.series.length > 0;
  const response = has_response ? make_response_figure(arm.response, 'distance-response') : null;
  const errors = test !== null && test.designs.length > 0 ? make_errors_figure(test) : null;
  return keep_filled([
    {
      id: 'overview',
      title: 'Overview',
      items: [
        make_tiles_item(data),
        arm === null || arm.health === null ? null : make_health_item(arm.health),
        arm === null ? null : make_results_table(data, arm),
        make_requirement_table(data.requirements),
        make_variable_table(data),
        make_limit_table(data),
        make_metric_table(data),
        fitness === null ? null : { ...make_half(fitness, 'overview-fitness'), ...(arm === null ? { width: 'full' as const } : {}) },
        response === null ? null : make_half(response, 'overview-response'),
        data.facts.length > 0 ? { kind: 'facts', id: 'facts', title: 'About', facts: data.facts } : null,
      ],
    },
    {
      id: 'training',
      title: 'Training',
      items: [
        fitness,
        make_variables_figure(data),
        ...make_importance_items(data),
        data.front === null ? null : make_front_figure(data.front, data.variables),
        make_reason_table(data),
      ],
    },
    {
      id: 'response',
      title: 'Response',
      items: [
        response,
        arm !== null && arm.sweep !== null && arm.sweep.series.length > 0 ? make_sweep_figure(arm.sweep) : null,
        errors,
        set ? make_case_figure(set) : null,
        ...(arm === null ? [] : make_signal_figures(arm.signals)),
        arm === null || arm.signals.reduction.distance_m.length === 0 ? null : make_reduction_figure(arm.signals),
        test === null ? null : make_failures_table(test),
      ],
    },
    {
      id: 'motion',
      title: 'Motion',
      items: [
        data.replays.length > 0 ? { kind: 'replay', id: 'replay', title: 'Replay', sets: data.replays } : null,
        ...(set ? [...make_joint_figures(set, robot), make_momentary_figure(set), make_saturation_table(set, robot)] : []),
      ],
    },
    { id: 'winner', title: 'Winner', items: make_record_items(data) },
    { id: 'design', title: 'Design', items: [arm === null ? null : make_design_table(arm)] },
  ]);
}
