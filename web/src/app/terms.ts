// The terms of statistics that the pages explain. Each explanation is that of docs/glossary.md, and a
// test compares both.

export interface Term {
  name: string; // its word in the glossary
  pattern: string; // of the forms in sentences and headings, as a regular expression
  meaning: string;
}

export const kTerms: Term[] = [
  {
    name: 'A12',
    pattern: 'A12',
    meaning:
      'The probability that a run of one optimizer is better than a run of the other, where an equal pair counts half. 0.5 means that neither is better.',
  },
  {
    name: "Holm's correction",
    pattern: "Holm(?:'s correction)?",
    meaning:
      'A change of the p-values that makes up for many pairs being tested: with it, all tests of a problem together call a difference significant by chance with probability at most 0.05.',
  },
  {
    name: "Wilcoxon's test",
    pattern: "Wilcoxon(?:'s (?:signed-rank )?tests?)?|signed-rank tests?",
    meaning: 'The signed-rank test of whether one of two optimizers is better, from the differences of their paired runs.',
  },
  {
    name: "Iman and Davenport's form",
    pattern: 'Iman(?: and |-)Davenport',
    meaning:
      "A form of Friedman's test that compares the differences of the mean ranks with their scatter (an F statistic). It is more exact for few replicates.",
  },
  {
    name: "Friedman's test",
    pattern: "Friedman(?:'s)?(?: test)?",
    meaning:
      'A test of whether the optimizers of a study differ at all, from their ranks in each replicate. It does not say which ones differ.',
  },
  {
    name: 'critical-difference diagram',
    pattern: 'critical[- ]difference diagrams?|critical differences?',
    meaning: 'A figure of the mean ranks of the optimizers. A bar joins optimizers that the tests do not tell apart.',
  },
  {
    name: 'ECDF',
    pattern: 'ECDFs?|shares? of (?:all )?(?:\\(run, target\\) )?pairs',
    meaning:
      'Empirical cumulative distribution function. Here it is the share of (run, target) pairs that are reached with at most a given number of simulated cases.',
  },
  {
    name: 'expected running time',
    pattern: '(?:expected )?running times?',
    meaning: 'The cases that all runs of an optimizer spent until they reached a target, divided by the number of runs that reached it.',
  },
  {
    name: 'quartiles',
    pattern: '(?:(?:lower|upper) )?quartiles?',
    meaning:
      'The numbers that divide sorted values into four equal parts. A quarter of the values is at most the lower quartile, and a quarter is at least the upper one.',
  },
  {
    name: 'rank of an optimizer',
    pattern: 'mean ranks?|rank of the median',
    meaning:
      'Its place among the optimizers in one replicate, 1 for the best; equal values share a rank. The mean rank is the mean over replicates. In the ranking over problems, the medians of each problem are ranked, and the mean is over problems.',
  },
  {
    name: 'resolution',
    pattern: 'resolutions?',
    meaning:
      "The smallest difference of a problem's values that matters: 1e-8 for functions, 1 µm of error for arms. Smaller differences count as none.",
  },
  {
    name: 'replicate',
    pattern: 'replicates?',
    meaning: 'One repetition of a study. In it all optimizers have the same training cases and the same start.',
  },
  { name: 'incumbent', pattern: 'incumbents?', meaning: 'The best feasible candidate so far, by the training cases.' },
  {
    name: 'schedule',
    pattern: 'schedules?',
    meaning:
      'The rule that gives a candidate its training cases: fixed:K (the first K), fresh:K (the next K for every generation), coevolution:K (K bred cases) or growing:K:FACTOR (the first K, and FACTOR times as many whenever progress is within the noise between cases).',
  },
  {
    name: 'success',
    pattern: 'success(?:es)?',
    meaning: 'A run whose value is at most one resolution above the known optimum. If the optimum is not known, every run with a value.',
  },
  {
    name: 'bootstrap',
    pattern: 'bootstrap(?:ped)?',
    meaning:
      'A way to find an interval for a number: the runs are drawn again at random, with repetition, thousands of times, and the interval holds the middle 95 % of the results.',
  },
  {
    name: 'hypervolume',
    pattern: '(?:missed )?hypervolume',
    meaning:
      'The part of the space of objectives, up to a reference point, that is worse than at least one design of a front. A front is better if its hypervolume is larger.',
  },
  {
    name: 'IGD+',
    pattern: 'IGD\\+',
    meaning:
      'The inverted generational distance plus: how far a front is from the common front of all runs, on the average over that front. Only objectives that are worse count, in units of its extent. Smaller is better.',
  },
  {
    name: 'anytime area',
    pattern: 'anytime areas?',
    meaning:
      'The area under an ECDF over a logarithmic axis of cases, as a share of the whole. It is large if an optimizer reaches many targets early.',
  },
  {
    name: 'simplex gradient',
    pattern: 'simplex gradients?',
    meaning: 'A unit of cost: one evaluation more than the problem has decision variables.',
  },
  {
    name: 'data profile',
    pattern: 'data profiles?',
    meaning: 'The share of (problem, replicate) pairs that an optimizer solves, against the cost in simplex gradients.',
  },
  {
    name: 'performance profile',
    pattern: 'performance profiles?',
    meaning:
      'The share of (problem, replicate) pairs that an optimizer solves, against the cost as a multiple of the cost of the fastest optimizer there.',
  },
  { name: 'test set', pattern: 'test set', meaning: 'The cases that judge the winner. They choose nothing.' },
  {
    name: 'validation set',
    pattern: 'validation set',
    meaning: 'The cases that choose the winner among the judged candidates. The optimizer never sees them.',
  },
];

// One group per term, in the order of kTerms, so that the first group that matched names the term.
const kAll = new RegExp('\\b(?:' + kTerms.map((term) => `(${term.pattern})`).join('|') + ')(?!\\w)', 'gi');

export interface TextPart {
  text: string;
  term?: Term;
}

// Splits a text into plain parts and terms. Only the first appearance of a term in the text is one.
export function split_terms(text: string): TextPart[] {
  const parts: TextPart[] = [];
  const found = new Set<Term>();
  let end = 0; // of the last term
  for (const match of text.matchAll(kAll)) {
    const term = kTerms[match.slice(1).findIndex((group) => group !== undefined)];
    if (found.has(term)) {
      continue;
    }
    found.add(term);
    if (match.index > end) {
      parts.push({ text: text.slice(end, match.index) });
    }
    parts.push({ text: match[0], term });
    end = match.index + match[0].length;
  }
  return end < text.length ? parts.concat([{ text: text.slice(end) }]) : parts;
}
