import type { StudyData } from '../data';
import type { Tab } from '../model';

export function make_study_tabs(data: StudyData): Tab[] {
  return [{ id: 'overview', title: 'Overview', items: [{ kind: 'facts', id: 'facts', title: 'About', facts: data.facts }] }];
}
