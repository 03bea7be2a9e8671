import type { RunData } from '../data';
import type { Tab } from '../model';

export function make_run_tabs(data: RunData): Tab[] {
  return [{ id: 'overview', title: 'Overview', items: [{ kind: 'facts', id: 'facts', title: 'About', facts: data.facts }] }];
}
