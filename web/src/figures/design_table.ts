// The numbers of the winner beside those of other designs, and the results of the designs.
import type { ArmEvidence, RunData } from '../data';
import type { Column, TableItem, Value } from '../model';
import { kMillimetres } from '../numbers';
import { times } from './quantities';

export function make_design_table(arm: ArmEvidence): TableItem | null {
  if (arm.parameters.length === 0) {
    return null;
  }
  const some_at_bound = arm.parameters.some((row) => row.at_bound !== '');
  const totals: Value[][] = [
    ['total torque', 'N m', ...arm.designs.map((design) => design.total_torque_n_m), 'sum', ''],
    ['total force', 'N', ...arm.designs.map((design) => design.total_force_n), 'sum', ''],
  ];
  return {
    kind: 'table',
    id: 'design-table',
    title: 'The design in numbers',
    caption:
      'All numbers of the winner beside those of the other designs. Only the numbers of kind "variable" were optimized. ' +
      (some_at_bound ? 'If a number of the winner is at a bound, the best value may be beyond it: the bound may be too tight. ' : '') +
      'The total torque is a sum over the joints that turn, the total force one over those that slide: of the two limits of each joint ' +
      'they take the one with the larger magnitude.',
    table: {
      columns: [
        { label: 'number' },
        { label: 'unit' },
        ...arm.designs.map((design): Column => ({ label: design.name, numeric: true, digits: 5 })),
        { label: 'kind' },
        { label: 'at bound' },
      ],
      rows: [
        ...arm.parameters.map((row): Value[] => [
          row.name,
          row.unit,
          ...arm.designs.map((_, i) => row.values[i] ?? null),
          row.is_variable ? 'variable' : 'fixed',
          row.at_bound,
        ]),
        ...totals.filter((row) => row.some((value) => typeof value === 'number')),
      ],
    },
  };
}

export function make_results_table(data: RunData, arm: ArmEvidence): TableItem | null {
  if (arm.results.length === 0) {
    return null;
  }
  const slides = arm.results.some((row) => row.total_force_n !== null);
  const has_published = arm.results.some((row) => row.published_mean_m !== null || row.published_torque_n_m !== null);
  const millimetres = (label: string): Column => ({ label, unit: 'mm', numeric: true });
  const name = (id: string) => arm.designs.filter((design) => design.id === id)[0]?.name ?? id;
  const sources = arm.results
    .filter((row) => row.source !== '')
    .map((row) => ` The source of the design "${name(row.design)}" is: ${row.source}.`)
    .join('');
  const where = data.test === null ? '' : ` on ${data.test.set}, simulated by ${data.test.engine}`;
  return {
    kind: 'table',
    id: 'results-table',
    title: 'Result',
    caption:
      `The positional errors of each design at rest${where}: the mean, the median, the error below which 95 % of the cases stay, and the worst case. ` +
      (has_published
        ? 'The published columns have the values that the thesis printed for the same design. The last column says where.'
        : 'No results of these designs are published.') +
      sources,
    table: {
      columns: [
        { label: 'design' },
        millimetres('mean'),
        ...(has_published ? [millimetres('published mean')] : []),
        millimetres('median'),
        millimetres('95 %'),
        millimetres('worst'),
        { label: 'failures', numeric: true },
        { label: 'cases', numeric: true },
        { label: 'total torque', unit: 'N m', numeric: true, digits: 6 },
        ...(slides ? [{ label: 'total force', unit: 'N', numeric: true, digits: 6 }] : []),
        ...(has_published ? [{ label: 'published torque', unit: 'N m', numeric: true, digits: 6 }, { label: 'where' }] : []),
      ],
      rows: arm.results.map((row) => [
        name(row.design),
        times(row.mean_m, kMillimetres),
        ...(has_published ? [times(row.published_mean_m, kMillimetres)] : []),
        times(row.median_m, kMillimetres),
        times(row.p95_m, kMillimetres),
        times(row.worst_m, kMillimetres),
        row.failures,
        row.cases,
        row.total_torque_n_m,
        ...(slides ? [row.total_force_n] : []),
        ...(has_published ? [row.published_torque_n_m, row.where] : []),
      ]),
    },
  };
}
