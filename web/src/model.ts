// What a page is made of, before anything is drawn. Pages are pure functions of their data, and the
// same figures serve the browser and `armwright plot`: nothing here or in figures/ may touch the DOM.
import type { EChartsOption } from './charts/echarts';
import type { Fact, PageBase, ReplaySet } from './data';
import type { Look } from './charts/look';

export type Value = string | number | null;

export interface Column {
  label: string;
  unit?: string;
  numeric?: boolean;
  digits?: number; // significant ones to show; 4 if not said
}

// Cells may carry what made them.
export interface Cell {
  value: Value;
  command?: string;
  note?: string;
  mark?: 'good' | 'near' | 'bad' | 'none'; // a colour beside what the text says as well
}

export interface DataTable {
  columns: Column[];
  rows: (Value | Cell)[][];
}

// Something that a reader may choose of a figure: a test case, a joint.
export interface Choice {
  id: string;
  label: string;
  options: { value: string; label: string }[];
  initial: string;
}
export type Picked = Record<string, string>;

// A point of a figure may carry these beside its `value`: the page shows them when it is chosen.
export interface Provenance {
  note?: string;
  command?: string;
}

export interface Figure {
  kind: 'figure';
  id: string; // unique in the page; name of the file that `armwright plot` writes
  title: string;
  caption: string; // what is shown and how to read it, whole sentences
  thesis?: string; // "Fig. 6.4": its counterpart in the source
  width?: 'half' | 'full'; // of the page; half if not said
  height?: number; // pixels; 340 if not said
  choices?: Choice[];
  // The abscissa is the time (s) of this replay case: the cursor is shared with the replay.
  time?: { replay: string; case: (picked: Picked) => string };
  draw(look: Look, picked: Picked): EChartsOption;
  table(picked: Picked): DataTable; // the numbers drawn, in the units drawn
}

export interface TableItem {
  kind: 'table';
  id: string;
  title: string;
  caption?: string;
  thesis?: string;
  table: DataTable;
}

export interface TextItem {
  kind: 'text';
  id: string;
  title: string;
  paragraphs: string[];
}

export interface FactsItem {
  kind: 'facts';
  id: string;
  title: string;
  facts: Fact[];
}

export interface ReplayItem {
  kind: 'replay';
  id: string;
  title: string;
  sets: ReplaySet[];
}

export type Item = Figure | TableItem | TextItem | FactsItem | ReplayItem;

export interface Tab {
  id: string;
  title: string;
  items: Item[];
}

export interface Page {
  data: PageBase;
  tabs: Tab[];
}
