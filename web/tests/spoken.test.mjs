// The sentences that screen readers say in place of charts: one table of each kind.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const { describe_table } = await load(`export { describe_table } from './src/app/spoken'`);

// A column is a text, unless its name begins with #. "#error (mm)" has a unit.
function say(names, rows) {
  const columns = names.map((name) => {
    const [, label, unit] = name.match(/^#?(.*?)(?: \((.*)\))?$/);
    return { label, unit, numeric: name.startsWith('#') };
  });
  return describe_table({ columns, rows });
}

const kCurves = [
  ['ga', 10, 8],
  ['ga', 20, 7.2],
  ['cmaes', 10, 9],
  ['cmaes', 20, { value: 6.3, command: 'armwright rerun' }],
];

test('of curves, the leader, its place and its distance', () => {
  const names = ['optimizer', '#cases', '#median (mm)'];
  assert.equal(say(names, kCurves), 'cmaes has the lowest median from 20 cases on: 6.30 mm at 20 cases, against 7.20 mm of ga.');
  assert.equal(say(names, kCurves.slice(0, 2)), 'ga has 7.20 mm at 20 cases (median).');
  const shares = ['optimizer', '#cost, as a multiple', '#share solved'];
  assert.equal(say(shares, kCurves), 'ga has the highest share solved from cost 20 on: 7.20 at cost 20, against 6.30 of cmaes.');
  const tied = [...kCurves, ['de', 10, 8.5], ['de', 20, 6.3], ['a', 20, 9], ['b', 20, 9.5], ['c', 20, 9.9]];
  assert.equal(
    say(names, tied),
    'cmaes and de have the lowest median: 6.30 mm at 20 cases, against 7.20 mm of ga, 9 mm of a, 9.50 mm of b and 9.90 mm of c.',
  );
  assert.match(say(names, [...tied, ['d', 20, 10]]), /against 7\.20 mm of ga, 9 mm of a, 9\.50 mm of b and 2 others\.$/);
});

test('of replicates, the medians', () => {
  assert.equal(
    say(['optimizer', '#replicate', '#error (mm)'], [...kCurves, ['ga', 30, null]]),
    'ga has the lowest median of error: 7.60 mm, against 7.65 mm of cmaes. That of ga ranges from 7.20 mm to 8 mm.',
  );
});

test('of signals, joints and points, the ranges', () => {
  assert.equal(
    say(['signal', '#time (s)', '#speed (m/s)'], [...kCurves, ['Step', 1, 0], ['Step', 2, 0]]),
    'The speed of ga ranges from 7.20 m/s to 8 m/s, of cmaes ranges from 6.30 m/s to 9 m/s and of Step stays at 0 m/s.',
  );
  assert.equal(
    say(
      ['#time (s)', '#joint_1 (°)', '#joint_1, target (°)'],
      [
        [0, -4, 1],
        [1, 5, 9],
      ],
    ),
    'joint_1 ranges from -4 ° to 5 °.',
  );
  assert.equal(
    say(
      ['#point', '#distance (cm)', 'counts', '#winner, mean (mm)', '#winner, standard error (mm)'],
      [
        [1, 80, 'no', 3, 1],
        [2, 160, 'yes', 2, 1],
        [3, 5, 'yes', null, 1],
      ],
    ),
    'winner ranges from 2 mm to 3 mm.',
  );
});

test('over generations and speeds, both ends', () => {
  const rows = [
    [1, 5, 10.5, 20],
    [2, 10, 7.5, 12],
  ];
  assert.equal(
    say(['#generation', '#cases', '#best (mm)', '#worst (mm)'], rows),
    'best is 10.5 mm at generation 1 and 7.50 mm at generation 2.',
  );
  assert.equal(say(['#evaluations', '#cases', '#best ()', '#worst ()'], rows), 'best is 10.5 at 1 evaluation and 7.50 at 2 evaluations.');
});

test('of one value per name, the lowest and the highest', () => {
  const rows = [
    ['ga', 2.5, null],
    ['cmaes', 1, null],
    ['random', 4, 7],
  ];
  assert.equal(
    say(['optimizer', '#mean rank', '#expected running time (cases)'], rows),
    'The lowest mean rank is 1 of cmaes, the highest 4 of random. The lowest expected running time is 7 cases of random.',
  );
});

test('of bins, the medians; of pairs, those told apart; of fronts, their size', () => {
  const bins = [
    [0, 1, 0, 5],
    [1, 2, 5, 5],
    [2, 4, 6, 0],
  ];
  assert.equal(
    say(['#from (mm)', '#to (mm)', '#winner (cases)', '#base (cases)'], bins),
    'Half of the values are at most 4 mm for winner and 1 mm for base.',
  );
  const pairs = [
    ['a', 'b', 0.01, 0.02, 'yes'],
    ['a', 'c', 0.5, 0.6, 'no'],
  ];
  assert.equal(
    say(['a, better by the pairs', 'b', '#p', '#p after Holm', 'told apart'], pairs),
    '1 of 2 pairs of optimizers are told apart: a and b.',
  );
  const front = [
    ['no', 1, 2],
    ['winner', 3, 4],
    ['yes', 2, 6],
  ];
  assert.equal(
    say(['on the front', '#error (mm)', '#torque (N m)'], front),
    '2 of 3 designs are on the front, where error ranges from 2 mm to 3 mm and torque ranges from 4 N m to 6 N m.',
  );
  const grid = [
    ['q1', 'ga', 2],
    ['q1', 'cmaes', 1],
    ['q2', 'ga', 1],
  ];
  assert.equal(say(['problem', 'optimizer', '#rank'], grid), 'The lowest rank: cmaes on q1 and ga on q2.');
});

test('a figure without values says so', () => {
  assert.equal(say(['optimizer', '#cases', '#median (mm)'], []), 'The figure has no values to show yet.');
  assert.equal(
    say(
      ['optimizer', '#cases', '#median (mm)'],
      [
        ['ga', 1, null],
        ['ga', 2, null],
      ],
    ),
    'The figure has no values to show yet.',
  );
});
