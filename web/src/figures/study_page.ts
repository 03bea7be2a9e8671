// The page of a comparison: the verdict first, then the statistics behind it.
import { shorten_all } from '../charts/names';
import { make_slugs } from '../charts/slugs';
import type { StudyData } from '../data';
import type { Item, Tab, TextItem } from '../model';
import { make_cost_quality } from './study_cost';
import { make_parallel } from './study_designs';
import { make_front } from './study_front';
import { make_standing_grid } from './study_grid';
import { make_failures, make_headline } from './study_headline';
import { make_pairs } from './study_pairs';
import { make_scope, type Scope } from './study_parts';
import { make_convergence, make_pooled_ecdf, make_profiles, make_runtime_ecdf } from './study_progress';
import { make_overall_ranks, make_problem_ranks } from './study_ranks';
import {
  make_cells_table,
  make_overall_table,
  make_pairs_table,
  make_ranking_table,
  make_running_times_table,
  make_targets_table,
} from './study_tables';
import { make_values } from './study_values';

// With more problems, tabs would not fit side by side. Figures then have a choice instead.
const kMostTabs = 6;

function keep(items: (Item | null)[]): Item[] {
  return items.filter((item) => item !== null) as Item[];
}

function make_unfinished(data: StudyData): TextItem | null {
  const missing = data.problems.reduce((sum, problem) => sum + problem.missing, 0);
  if (data.finished && missing === 0) {
    return null;
  }
  const progress = data.progress ? data.progress.done + ' of ' + data.progress.total + ' ' + data.progress.unit + ' are done. ' : '';
  return {
    kind: 'text',
    id: 'unfinished',
    title: 'Unfinished',
    paragraphs: [
      progress +
        (missing > 0
          ? missing +
            (missing === 1 ? ' run has' : ' runs have') +
            ' not ended. All numbers are those of the runs that have ended. Problems with missing runs have no ranks and no tests. '
          : '') +
        'The results are preliminary and change as more runs end.',
    ],
  };
}

function make_verdict_items(data: StudyData, all: Scope): Item[] {
  const everyone = make_scope(data, data.problems, '');
  const single = data.problems.length === 1;
  const headline: TextItem = {
    kind: 'text',
    id: 'headline',
    title: 'Verdict',
    style: 'headline',
    paragraphs: [make_headline(everyone), make_failures(everyone)],
  };
  const verdict: TextItem = {
    kind: 'text',
    id: 'verdict',
    title: 'The verdict in full',
    style: 'folded',
    paragraphs: data.verdict.length > 0 ? data.verdict : ['There is no verdict yet.'],
  };
  return keep([
    headline,
    make_standing_grid(all),
    make_unfinished(data),
    verdict,
    single ? make_problem_ranks(all, 'ranks') : make_overall_ranks(all),
    single ? make_ranking_table(all) : make_overall_table(all),
    { kind: 'facts', id: 'facts', title: 'About', facts: data.facts },
  ]);
}

function make_problem_items(scope: Scope): Item[] {
  const single = scope.data.problems.length === 1;
  return keep([
    make_convergence(scope),
    make_values(scope),
    make_runtime_ecdf(scope),
    make_cost_quality(scope),
    make_front(scope),
    single ? null : make_problem_ranks(scope, 'replicate-ranks' + scope.suffix),
    make_pairs(scope),
    single ? null : make_ranking_table(scope),
    make_targets_table(scope),
    make_running_times_table(scope),
    make_pairs_table(scope),
    make_cells_table(scope),
  ]);
}

// `shown` are the optimizers of the figures and tables, by index; without it, all are shown.
export function make_study_tabs(data: StudyData, shown?: number[]): Tab[] {
  const all = make_scope(data, data.problems, '', shown);
  const tabs: Tab[] = [{ id: 'verdict', title: 'Verdict', items: make_verdict_items(data, all) }];
  const apart = data.problems.length <= kMostTabs;
  const slugs = make_slugs(data.problems.map((problem) => problem.label));
  const titles = shorten_all(data.problems.map((problem) => problem.label));
  const scopes = apart
    ? data.problems.map((problem, i) => make_scope(data, [problem], data.problems.length > 1 ? '-' + slugs[i] : '', shown))
    : [all];
  scopes.forEach((scope, i) =>
    tabs.push({
      id: apart ? 'problem-' + slugs[i] : 'problems',
      title: apart ? titles[i] : 'Problems',
      items: make_problem_items(scope),
    }),
  );
  const profiles = keep([make_pooled_ecdf(all), ...make_profiles(all)]);
  if (profiles.length > 0) {
    tabs.push({ id: 'profiles', title: 'Profiles', items: profiles });
  }
  const designs = keep(scopes.map(make_parallel));
  if (designs.length > 0) {
    tabs.push({ id: 'designs', title: 'Designs', items: designs });
  }
  if (data.replays.length > 0) {
    tabs.push({ id: 'replay', title: 'Replay', items: [{ kind: 'replay', id: 'replay', title: 'Replay', sets: data.replays }] });
  }
  return tabs;
}
