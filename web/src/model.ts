// The parts of a page before anything is drawn. Pages are pure functions of their data, and the
// browser and `armwright plot` use the same figures. Therefore this file and figures/ must not use
// the DOM.
import type { EChartsOption } from './charts/echarts';
import type { Fact, PageBase, ReplaySet, WinnerFile } from './data';
import type { Look } from './charts/look';
import type { Range } from './charts/zoom';

export type Value = string | number | null;

export interface Column {
  label: string;
  unit?: string;
  numeric?: boolean;
  digits?: number; // significant digits to show; default 4
}

// A cell may have the command that made its value.
export interface Cell extends Provenance {
  value: Value;
  mark?: 'good' | 'near' | 'bad' | 'none'; // a colour with the same meaning as the text
}

export interface DataTable {
  columns: Column[];
  rows: (Value | Cell)[][];
}

// A choice that a figure offers to the reader: a test case, a joint.
export interface Choice {
  id: string;
  label: string;
  options: { value: string; label: string }[];
  initial: string;
}
export type Picked = Record<string, string>;

// The provenance of a point of a figure. The page shows it when the reader chooses the point.
export interface Provenance {
  note?: string;
  command?: string;
  file?: { name: string; text: string }; // to save before the command
}

export interface Figure {
  kind: 'figure';
  id: string; // unique in the page; also the name of the file that `armwright plot` writes
  title: string;
  caption: string; // whole sentences: the content of the figure and how to read it
  thesis?: string; // the corresponding figure of the thesis, such as "Fig. 6.4"
  width?: 'half' | 'full'; // of the page; default half
  height?: number; // pixels; default 340
  choices?: Choice[];
  // Present if the abscissa is the time (s) of this replay case. The figure then shares the cursor of
  // the replay. If `panels` is present, each panel shows one part of the case and its time begins
  // with that part.
  time?: { replay: string; case: (picked: Picked) => string; panels?: (picked: Picked) => Range[] };
  draw(look: Look, picked: Picked, zoom?: Range): EChartsOption; // with `zoom`, at least this part of the abscissa
  table(picked: Picked): DataTable; // the drawn numbers, in the drawn units
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
  style?: 'headline' | 'folded'; // larger letters; or closed until the reader opens it or prints the page
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

// Files that a problem left. Images are shown, and every file can be saved.
export interface FilesItem {
  kind: 'files';
  id: string;
  title: string;
  caption: string;
  files: WinnerFile[];
}

// A number that a reader looks for first.
export interface Tile {
  label: string;
  value: string;
  detail: string; // may be empty
  mark?: Cell['mark'];
}

// One line of a card of grades. A sign and a word repeat the meaning of the colour.
export interface GradeLine {
  name: string;
  state: string; // "✓ good"
  mark: NonNullable<Cell['mark']>;
  value: string;
  meaning: string; // empty if the line is good
}

// Tiles, or a verdict and the lines that it rests on.
export interface SummaryItem {
  kind: 'summary';
  id: string;
  title: string; // may be empty
  verdict?: { text: string; mark: NonNullable<Cell['mark']> };
  tiles: Tile[];
  lines: GradeLine[];
  caption?: string;
}

export type Item = Figure | TableItem | TextItem | FactsItem | ReplayItem | FilesItem | SummaryItem;

export interface Tab {
  id: string;
  title: string;
  items: Item[];
}

export interface Page {
  data: PageBase;
  tabs: Tab[];
}
