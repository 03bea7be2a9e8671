import type { ReproductionData } from '../data';
import type { Tab } from '../model';

export function make_reproduction_tabs(data: ReproductionData): Tab[] {
  return [{ id: 'overview', title: 'Overview', items: [{ kind: 'facts', id: 'facts', title: 'About', facts: data.facts }] }];
}
