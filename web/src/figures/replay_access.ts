// The common parts of the figures over time: the cases, designs and numbers of a replay set for the
// choices of the reader.
import { decimate } from '../charts/decimate';
import { shorten, shorten_all } from '../charts/names';
import type { Range } from '../charts/zoom';
import type { DesignInfo, Motion, Packed, ReplayCase, ReplaySet, Segment } from '../data';
import type { Choice, Picked } from '../model';
import { unpack } from '../numbers';

export const kAll = 'all';

export function make_case_choice(set: ReplaySet): Choice {
  return {
    id: 'case',
    label: 'case',
    options: set.cases.map((one) => ({ value: one.id, label: shorten(one.label, 60) })),
    initial: set.cases[0].id,
  };
}

export function get_case(set: ReplaySet, picked: Picked): ReplayCase {
  return set.cases.filter((one) => one.id === picked.case)[0] ?? set.cases[0];
}

export function make_design_choice(set: ReplaySet, with_all: boolean): Choice {
  const names = shorten_all(set.designs.map((one) => one.name));
  const options = set.designs.map((one, i) => ({ value: one.id, label: names[i] }));
  return {
    id: 'design',
    label: 'design',
    options: with_all && options.length > 1 ? [{ value: kAll, label: 'all' }, ...options] : options,
    initial: with_all && options.length > 1 ? kAll : (set.designs[0]?.id ?? ''),
  };
}

export interface Moved {
  design: DesignInfo;
  index: number; // index of the design, which selects its colour
  name: string;
  motion: Motion;
}

// Returns the motions of the chosen designs on a case.
export function get_motions(set: ReplaySet, one: ReplayCase, picked: Picked): Moved[] {
  const names = shorten_all(set.designs.map((design) => design.name));
  const moved: Moved[] = [];
  set.designs.forEach((design, index) => {
    const wanted = picked.design === undefined || picked.design === kAll || picked.design === design.id;
    const motion = one.motions.filter((each) => each.design === design.id)[0];
    if (wanted && motion !== undefined) {
      moved.push({ design, index, name: names[index], motion });
    }
  });
  return moved;
}

// Returns every `count`-th number from `offset` on, which is one column of numbers packed by rows.
export function get_column(packed: Packed, count: number, offset: number): Float32Array {
  return take_column(unpack(packed), count, offset);
}

export function take_column(all: Float32Array, count: number, offset: number): Float32Array {
  const column = new Float32Array(Math.floor(all.length / count));
  for (let i = 0; i < column.length; ++i) {
    column[i] = all[i * count + offset];
  }
  return column;
}

// Returns the time of a row. Row k is the state at the end of control period k.
export function get_time(set: ReplaySet, row: number): number {
  return (row + 1) * set.task.control_period_s;
}

// Returns the indices of the rows to draw: all that a line needs, and of a part of the time `zoom`
// those within it and one beyond each end.
export function choose_rows(set: ReplaySet, values: Float32Array, zoom: Range | undefined): number[] {
  const dt = set.task.control_period_s;
  const first = zoom === undefined ? 0 : Math.max(0, Math.floor(zoom.from / dt) - 2);
  const last = zoom === undefined ? values.length : Math.min(values.length, Math.ceil(zoom.to / dt) + 1);
  return decimate(values.subarray(first, Math.max(first, last))).map((i) => first + i);
}

// Returns the range of time in which the errors of a move count.
export function get_window(set: ReplaySet, segment: Segment): [number, number] {
  const dt = set.task.control_period_s;
  return [segment.window_start * dt, segment.steps * dt];
}
