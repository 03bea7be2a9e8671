// The published numbers beside ours, each with a grade: whether both agree, and if not, the reason.
// A number of ours agrees if it differs from the published one by at most a tenth of it. A mean over
// test cases of which none failed also agrees if the difference is at most two standard errors: with
// a failed case, that case determines both the mean and its standard error. Otherwise our number is
// smaller or larger. Smaller errors and torques are better.
import { join_names, shorten } from '../charts/names';
import type { ReproductionData } from '../data';
import type { Cell, TableItem, TextItem } from '../model';
import { kMillimetres } from '../numbers';
import { is_number, times } from './quantities';

const kTolerance = 0.1; // share of the published number
const kStandardErrors = 2;
const kMostNames = 4;
const kKilo = 1e-3;

export type Agreement = 'agrees' | 'smaller' | 'larger' | 'missing';

const kStates: { [grade in Agreement]: { text: string; mark: NonNullable<Cell['mark']> } } = {
  agrees: { text: '✓ agrees', mark: 'good' },
  smaller: { text: '▼ smaller', mark: 'near' },
  larger: { text: '▲ larger', mark: 'bad' },
  missing: { text: '? no number', mark: 'none' },
};

interface Comparison {
  label: string;
  quantity: string;
  published: number;
  ours: number | null;
  grade: Agreement;
  reason: string; // empty if none is known
  command: string;
}

// Grades a number of ours. `standard_error` is 0 for a number without a spread, such as a torque, and
// for a mean that counts failed cases.
export function grade_agreement(ours: number | null, published: number, standard_error: number): Agreement {
  if (!is_number(ours)) {
    return 'missing';
  }
  const difference = ours - published;
  const allowed = Math.max(kTolerance * Math.abs(published), kStandardErrors * standard_error);
  return Math.abs(difference) <= allowed ? 'agrees' : difference < 0 ? 'smaller' : 'larger';
}

// Returns one comparison per published number. A torque that belongs to several results of a design
// is listed once.
function compare_all(data: ReproductionData): Comparison[] {
  const all: Comparison[] = [];
  const add_torque = (row: { reason: string; command: string }, label: string, published: number | null, ours: number | null) => {
    if (is_number(published)) {
      const grade = grade_agreement(ours, published, 0);
      all.push({
        label,
        quantity: 'total torque (kN m)',
        published: published * kKilo,
        ours: times(ours, kKilo),
        grade,
        reason: row.reason,
        command: row.command,
      });
    }
  };
  data.rows.forEach((row) => {
    const published = row.published_error_m;
    if (is_number(published)) {
      const spread = row.failures === 0 ? (row.standard_error_m ?? 0) : 0;
      all.push({
        label: row.label,
        quantity: 'mean error (mm)',
        published: published * kMillimetres,
        ours: times(row.mean_m, kMillimetres),
        grade: grade_agreement(row.mean_m, published, spread),
        reason: row.reason,
        command: row.command,
      });
    }
  });
  data.rows.forEach((row, i) => {
    if (data.rows.slice(0, i).every((one) => one.design !== row.design || one.published_torque_n_m !== row.published_torque_n_m)) {
      add_torque(row, row.label, row.published_torque_n_m, row.torque_n_m);
    }
  });
  data.runs.forEach((run) => add_torque(run, run.name, run.published_torque_n_m, run.torque_n_m));
  return all;
}

function is_difference(one: Comparison): boolean {
  return one.grade === 'smaller' || one.grade === 'larger';
}

function describe(all: Comparison[], grade: Agreement): string {
  const labels = all
    .filter((one) => one.grade === grade)
    .map((one) => shorten(one.label))
    .filter((label, i, labels) => labels.indexOf(label) === i);
  const more = labels.length - kMostNames;
  return join_names(more > 1 ? labels.slice(0, kMostNames).concat([`${more} more`]) : labels);
}

// Returns the sentence at the top of the page, or null if there is no published number.
export function make_agreement_headline(data: ReproductionData): TextItem | null {
  const all = compare_all(data);
  if (all.length === 0) {
    return null;
  }
  const count = (grade: Agreement) => all.filter((one) => one.grade === grade).length;
  const open = all.filter((one) => is_difference(one) && one.reason === '');
  const clauses = [`${count('agrees')} of the ${all.length} published numbers agree with ours`];
  if (count('smaller') > 0) {
    clauses.push(`ours is smaller for ${count('smaller')} (${describe(all, 'smaller')})`);
  }
  if (count('larger') > 0) {
    clauses.push(`ours is larger for ${count('larger')} (${describe(all, 'larger')})`);
  }
  if (count('missing') > 0) {
    clauses.push(`ours has no number for ${count('missing')}`);
  }
  if (all.some(is_difference)) {
    const verb = open.length === 1 ? 'is' : 'are';
    clauses.push(open.length === 0 ? 'every difference has a known reason' : `${open.length} of these differences ${verb} not explained`);
  }
  return { kind: 'text', id: 'headline', title: 'Published and ours', style: 'headline', paragraphs: [clauses.join('; ') + '.'] };
}

export function make_agreement_table(data: ReproductionData): TableItem | null {
  const all = compare_all(data);
  if (all.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'agreement',
    title: 'Each published number beside ours',
    caption:
      `A number agrees if ours differs from it by at most ${100 * kTolerance} % of it, or by at most two standard errors of our mean if no test case failed. ` +
      'Otherwise ours is smaller, which is better, or larger, which is worse. Errors are means over the test cases. A reason is given where one is known.',
    table: {
      columns: [
        { label: 'result' },
        { label: 'quantity' },
        { label: 'published', numeric: true },
        { label: 'ours', numeric: true },
        { label: 'ours / published', numeric: true, digits: 3 },
        { label: 'agreement' },
        { label: 'reason of the difference' },
      ],
      rows: all.map((one) => [
        one.label,
        one.quantity,
        one.published,
        { value: one.ours, command: one.command || undefined },
        is_number(one.ours) && one.published !== 0 ? one.ours / one.published : null,
        { value: kStates[one.grade].text, mark: kStates[one.grade].mark },
        is_difference(one) ? one.reason || 'not explained' : null,
      ]),
    },
  };
}
