// The progress of a run or study that is not finished: words for the bar on top of the page, and the
// tables that `armwright watch` adds to the first tab.
import type { PageBase, PageData, Watched } from '../data';
import type { Item, TableItem } from '../model';
import { format_duration, format_number } from '../numbers';

function describe_failures(count: number): string {
  return count === 0 ? 'no candidate has failed' : count + (count === 1 ? ' candidate has failed' : ' candidates have failed');
}

// Returns the words beside the bar, the amount of work first. Empty for a finished page.
export function describe_progress({ progress, watched }: PageBase): string[] {
  if (progress === null) {
    return [];
  }
  const share = progress.total > 0 ? ` (${Math.floor((100 * progress.done) / progress.total)} %)` : '';
  const words = [`${progress.done} of ${progress.total} ${progress.unit}${share}`];
  if (watched === null) {
    return words;
  }
  words.push(watched.left_s === null ? 'time left: unknown yet' : `about ${format_duration(watched.left_s)} left`);
  if (watched.simulations !== null) {
    words.push(
      watched.per_second === null
        ? 'simulations per second: unknown yet'
        : watched.per_second === 0
          ? 'no simulation in the last minute'
          : `${format_number(watched.per_second, 3)} simulations per second in the last minute`,
      describe_failures(watched.failed_evaluations),
    );
  }
  return words;
}

function make_running_table(watched: Watched): TableItem {
  return {
    kind: 'table',
    id: 'running',
    title: 'Cells that are running',
    table: {
      columns: [
        { label: 'cell' },
        { label: 'cases', numeric: true },
        { label: 'of', numeric: true },
        { label: 'done', unit: '%', numeric: true, digits: 3 },
        { label: 'process' },
      ],
      rows: watched.running.map((one) => [
        one.cell,
        one.done,
        one.total,
        one.done === null || one.total === 0 ? null : (100 * one.done) / one.total,
        one.process,
      ]),
    },
  };
}

function make_failure_table(watched: Watched): TableItem {
  return {
    kind: 'table',
    id: 'failures-so-far',
    title: 'Failures so far',
    caption:
      'Cells that have failed or give no sign of life, then the newest candidates with a simulation that failed. ' +
      'A failed candidate is an ordinary result: the optimizer gets a penalty for it.',
    table: {
      columns: [{ label: 'what' }, { label: 'state' }, { label: 'reason' }],
      rows: watched.failures.map((one) => [one.where, one.state, one.reason]),
    },
  };
}

// A table without rows is one sentence. It has the same place, so that nothing below it moves.
function make_slot(table: TableItem, empty: string): Item {
  const { id, title } = table;
  return table.table.rows.length > 0 ? table : { kind: 'text', id, title, paragraphs: [empty] };
}

// Returns the items of the first tab with the tables of a page that is being watched: a study's cells
// that are running come first, failures after the headline.
export function add_watched_items({ finished, kind, watched }: PageData, items: Item[]): Item[] {
  if (finished || watched === null) {
    return items;
  }
  return [
    ...(kind === 'study' ? [make_slot(make_running_table(watched), 'No cell is running.')] : []),
    ...items.slice(0, 1),
    make_slot(make_failure_table(watched), 'Nothing has failed.'),
    ...items.slice(1),
  ];
}
