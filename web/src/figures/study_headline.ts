// The sentences at the top of a comparison. The first one repeats what the verdict says about the
// leader of each problem, and is never stronger than the verdict. The second one names failures.
import { join_names, shorten } from '../charts/names';
import type { StudyOptimizerResult } from '../data';
import type { Scope } from './study_parts';
import { count_best, find_standing, is_decided, order_by_standing, type Lead, type ProblemStanding } from './study_standing';

const kMostNames = 5;

// Returns "a, b and c", or "a, b and 7 more" if there are more than `most` names.
function list_names(names: string[], most: number): string {
  if (names.length <= most) {
    return join_names(names);
  }
  const more = names.length - most;
  return most > 0 ? join_names(names.slice(0, most).concat([more + ' more'])) : more + (more === 1 ? ' other' : ' others');
}

// Says who cannot be told apart from the leader on the problems where it is best.
function describe_undecided(scope: Scope, led: ProblemStanding[], order: number[]): string {
  const count = (o: number) => led.filter((one) => one.standings[o] === 'undecided').length;
  const pick = (matches: (n: number) => boolean) => order.filter((o) => matches(count(o))).map((o) => scope.names[o]);
  const always = pick((n) => n === led.length);
  const sometimes = pick((n) => n > 0 && n < led.length);
  if (always.length === 0 && sometimes.length === 0) {
    return '';
  }
  const first = always.length === 0 ? '' : list_names(always, kMostNames) + ' cannot be told apart from it';
  if (led.length === 1) {
    return first + (scope.problems.length > 1 ? ' there' : '');
  }
  const rest = list_names(sometimes, Math.max(0, kMostNames - always.length));
  if (always.length === 0) {
    return rest + ' cannot be told apart from it on some of them';
  }
  return first + ' on any of them' + (sometimes.length > 0 ? ', and ' + rest + ' cannot on some of them' : '');
}

// Returns what the verdict says about problems on which no optimizer is best, after "on 2 of them".
const kReasons: Partial<Record<Lead, string>> = {
  beaten: 'another optimizer beats the leader of the ranking',
  open: 'the leader of the ranking cannot be told apart from any other optimizer',
  none_apart: 'no two optimizers can be told apart',
  no_values: 'no optimizer found a design that has a value',
};

function describe_others(scope: Scope, all: ProblemStanding[]): string[] {
  const count = (lead: Lead) => all.filter((one) => one.lead === lead).length;
  const clauses: string[] = [];
  (['beaten', 'open', 'none_apart', 'no_values'] as Lead[]).forEach((lead) => {
    if (count(lead) > 0) {
      clauses.push('on ' + count(lead) + ' ' + kReasons[lead]);
    }
  });
  if (count('too_few') > 0) {
    clauses.push('on ' + count('too_few') + ' no pair can be decided with ' + describe_replicates(scope));
  }
  if (count('unfinished') > 0) {
    clauses.push(count('unfinished') + (count('unfinished') === 1 ? ' problem is' : ' problems are') + ' unfinished');
  }
  return clauses;
}

function describe_replicates(scope: Scope): string {
  const n = scope.data.replicates;
  return n + (n === 1 ? ' replicate' : ' replicates') + '; at least ' + scope.data.fewest_replicates + ' are needed';
}

// Returns the sentence for problems of which none has an optimizer that is best.
function describe_no_best(scope: Scope, all: ProblemStanding[]): string {
  const where = all.length === 1 ? 'on ' + shorten(scope.problems[0].label) : 'on any of the ' + all.length + ' problems';
  const { lead, leader, standings } = all[0];
  if (all.some((one) => one.lead !== lead)) {
    return 'No optimizer is shown to be best ' + where + ': ' + describe_others(scope, all).join('; ') + '.';
  }
  const single = all.length === 1;
  switch (lead) {
    case 'unfinished':
      return 'There is no verdict yet: runs ' + (single ? where : 'on each of the ' + all.length + ' problems') + ' have not ended.';
    case 'no_values':
      return 'No optimizer found a design that has a value on the test set ' + where + '.';
    case 'too_few':
      return 'No pair of optimizers can be decided ' + where + ' with ' + describe_replicates(scope) + '.';
    case 'none_apart':
      return 'No two optimizers can be told apart ' + where + '.';
    case 'beaten': {
      const winners = scope.names.filter((_, o) => standings[o] === 'better');
      return single
        ? 'No optimizer is shown to be best ' +
            where +
            ': ' +
            list_names(winners, kMostNames) +
            (winners.length === 1 ? ' beats ' : ' beat ') +
            scope.names[leader] +
            ', although ' +
            scope.names[leader] +
            ' leads the ranking.'
        : 'No optimizer is shown to be best ' + where + ': on each, ' + kReasons.beaten + '.';
    }
    default:
      return (
        'No optimizer is shown to be best ' +
        where +
        ': ' +
        (single ? scope.names[leader] + ', which leads the ranking,' : 'on each, the leader of the ranking') +
        ' cannot be told apart from any other.'
      );
  }
}

function get_led(all: ProblemStanding[], optimizer: number): ProblemStanding[] {
  return all.filter((one) => is_decided(one.lead) && one.leader === optimizer);
}

// Says on how many problems the optimizer `order[0]` is best, and who cannot be told apart from it.
function describe_first(scope: Scope, all: ProblemStanding[], order: number[]): string[] {
  const led = get_led(all, order[0]);
  const where = all.length === 1 ? shorten(scope.problems[0].label) : led.length + ' of ' + all.length + ' problems';
  if (led.every((one) => one.lead === 'best_of_all')) {
    const beaten = all.length > 1 ? ', where it beats every other optimizer' : ': it beats every other optimizer';
    return [scope.names[order[0]] + ' is best on ' + where + beaten];
  }
  return [scope.names[order[0]] + ' ranks best on ' + where, describe_undecided(scope, led, order)];
}

// Says on how many problems several optimizers are best that are best equally often.
function describe_equals(scope: Scope, all: ProblemStanding[], equals: number[]): string[] {
  const led = equals.reduce((list, o) => list.concat(get_led(all, o)), [] as ProblemStanding[]);
  const open = led.filter((one) => one.lead === 'best').length;
  const names = list_names(
    equals.map((o) => scope.names[o]),
    kMostNames,
  );
  return [names + ' rank best on ' + led.length / equals.length + ' of ' + all.length + ' problems each'].concat(
    open > 0 ? ['on ' + open + ' of these, others cannot be told apart from the best one'] : [],
  );
}

// Names the optimizers that are best on fewer problems than the first one.
function describe_later(scope: Scope, all: ProblemStanding[], winners: number[], most: number): string[] {
  const clauses: string[] = [];
  for (let count = most - 1; count > 0; --count) {
    const names = winners.filter((o) => count_best(all, o) === count).map((o) => scope.names[o]);
    if (names.length > 0) {
      clauses.push(list_names(names, kMostNames) + (names.length === 1 ? ' ranks best on ' + count : ' rank best on ' + count + ' each'));
    }
  }
  return clauses;
}

// Returns one sentence, such as "a ranks best on 2 of 3 problems; b cannot be told apart from it on
// any of them; on 1 no two optimizers can be told apart." An optimizer "is best" if it beats every
// other one; it "ranks best" if it beats only some. Where the verdict decides nothing, the sentence
// says so.
export function make_headline(scope: Scope): string {
  if (scope.names.length < 2 || scope.problems.length === 0) {
    return (
      'There is nothing to compare: ' +
      (scope.names.length === 1 ? 'one optimizer' : scope.names.length === 0 ? 'no optimizer' : 'no problem') +
      ' took part.'
    );
  }
  const all = scope.problems.map((problem) => find_standing(scope.data, problem));
  const order = order_by_standing(scope, all);
  const winners = order.filter((o) => count_best(all, o) > 0);
  if (winners.length === 0) {
    return describe_no_best(scope, all);
  }
  const most = count_best(all, winners[0]);
  const first = winners.filter((o) => count_best(all, o) === most);
  const clauses = (first.length === 1 ? describe_first(scope, all, order) : describe_equals(scope, all, first))
    .concat(describe_later(scope, all, winners, most))
    .concat(describe_others(scope, all));
  return clauses.join('; ') + '.';
}

// Says whose runs failed, and whose have no value on the test set, with their numbers.
export function make_failures(scope: Scope): string {
  const count = (o: number, get: (result: StudyOptimizerResult) => number) =>
    scope.problems.reduce((sum, problem) => sum + get(problem.results[o]), 0);
  const describe = (get: (result: StudyOptimizerResult) => number): string[] =>
    scope.names
      .map((name, o) => ({ name, some: count(o, get), all: count(o, (result) => result.cells.length) }))
      .filter(({ some }) => some > 0)
      .sort((a, b) => b.some - a.some)
      .map(({ name, some, all }) => `${name} in ${some} of ${all} runs`);
  const failed = describe((result) => result.failed);
  const empty = describe((result) => result.infinite);
  if (failed.length === 0 && empty.length === 0) {
    return 'No optimizer failed, and every run has a value on the test set.';
  }
  return (
    (failed.length === 0 ? 'No optimizer failed.' : 'Failed by a fault of their own: ' + list_names(failed, kMostNames) + '.') +
    (empty.length === 0
      ? ''
      : ' Without a value on the test set, because a simulation failed or a constraint is violated: ' + list_names(empty, kMostNames) + '.')
  );
}
