// What the tests decide about the leader of each problem, by the rules of the verdict
// (src/study/analysis/verdict.cpp): ranks choose the leader, and only the tests of the pairs decide
// whether another optimizer differs from it.
import type { StudyData, StudyPair, StudyProblem } from '../data';
import { find_pair } from './study_pairs';
import { type Scope, sort_by } from './study_parts';

// What the verdict says about an optimizer on a problem, or why it says nothing.
// - best: it leads the ranking, beats at least one other optimizer and is beaten by none
// - worse: the leader beats it
// - better: it beats the leader, although the leader leads the ranking
// - undecided: the test does not tell it apart from the leader; also the leader itself, if it is
//   not best
// - untested: the problem has no verdict
export type Standing = 'best' | 'worse' | 'better' | 'undecided' | 'untested';

// What the verdict says about the leader of a problem, or why it says nothing.
// - best_of_all: it beats every other optimizer
// - best: it beats some, and cannot be told apart from the others
// - beaten: another optimizer beats it
// - open: it cannot be told apart from any other, though some other pair is told apart
// - none_apart: no two optimizers can be told apart
// - too_few: with so few replicates no pair can be decided
// - no_values: no optimizer found a design with a value
// - unfinished: cells have not ended
// - alone: there is one optimizer at most
export type Lead = 'best_of_all' | 'best' | 'beaten' | 'open' | 'none_apart' | 'too_few' | 'no_values' | 'unfinished' | 'alone';

export interface ProblemStanding {
  lead: Lead;
  leader: number; // first by rank; -1 if the problem has no verdict
  standings: Standing[]; // one per optimizer
}

export function is_decided(lead: Lead): boolean {
  return lead === 'best_of_all' || lead === 'best';
}

function explain_no_verdict(data: StudyData, problem: StudyProblem): Lead | null {
  if (data.optimizers.length < 2) {
    return 'alone';
  }
  if (problem.missing > 0 || problem.order.length === 0) {
    return 'unfinished';
  }
  if (problem.results.every((one) => one.infinite === one.cells.length)) {
    return 'no_values';
  }
  return data.fewest_replicates !== null && data.replicates < data.fewest_replicates ? 'too_few' : null;
}

export function find_standing(data: StudyData, problem: StudyProblem): ProblemStanding {
  const no_verdict = explain_no_verdict(data, problem);
  if (no_verdict !== null) {
    return { lead: no_verdict, leader: -1, standings: data.optimizers.map((): Standing => 'untested') };
  }
  const leader = problem.order[0];
  const standings = data.optimizers.map((_, o): Standing => {
    const pair: StudyPair | undefined = o === leader ? undefined : find_pair(problem.pairs, leader, o);
    return pair === undefined || !pair.significant ? 'undecided' : pair.a === leader ? 'worse' : 'better';
  });
  const count = (standing: Standing) => standings.filter((one) => one === standing).length;
  let lead: Lead = 'best';
  if (!problem.pairs.some((pair) => pair.significant)) {
    lead = 'none_apart';
  } else if (count('better') > 0) {
    lead = 'beaten';
  } else if (count('worse') === 0) {
    lead = 'open';
  } else if (count('undecided') === 1) {
    lead = 'best_of_all'; // the leader itself is the one
  }
  if (is_decided(lead)) {
    standings[leader] = 'best';
  }
  return { lead, leader, standings };
}

export function count_best(standings: ProblemStanding[], optimizer: number): number {
  return standings.filter((one) => is_decided(one.lead) && one.leader === optimizer).length;
}

// Returns the optimizers by the number of problems on which they are best, then by mean rank.
// `standings` has one item per problem of the scope.
export function order_by_standing(scope: Scope, standings: ProblemStanding[]): number[] {
  const overall = scope.data.overall;
  const order = scope.problems.length > 0 ? scope.problems[0].order : [];
  const get_rank = (o: number): number => {
    const place = order.indexOf(o);
    return overall && scope.problems.length > 1 ? (overall.mean_ranks[o] ?? Infinity) : place < 0 ? Infinity : place;
  };
  const by_rank = sort_by(
    scope.names.map((_, o) => o),
    get_rank,
  );
  return sort_by(by_rank, (o) => -count_best(standings, o));
}
