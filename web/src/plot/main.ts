// The figures without a browser: functions that the program calls (src/report/page/plotter.cpp).
// All their arguments and results are strings.
import './polyfills';
import { draw_svg, get_initial_picks, get_paper_size } from '../charts/svg';
import { kDark, kLight } from '../charts/look';
import { to_csv } from '../csv';
import type { PageData } from '../data';
import { make_page } from '../figures/page';
import type { DataTable, Figure, Picked, TableItem } from '../model';

interface Entry {
  tab: string;
  item: Figure | TableItem;
}

let entries: Entry[] = [];

function find(id: string): Figure | TableItem {
  const found = entries.filter((entry) => entry.item.id === id)[0];
  if (found === undefined) {
    throw new Error('there is no figure ' + id);
  }
  return found.item;
}

function get_picks(figure: Figure, picks: string): Picked {
  const picked = get_initial_picks(figure);
  const wanted = JSON.parse(picks) as Picked;
  Object.keys(wanted).forEach((id) => {
    picked[id] = wanted[id];
  });
  return picked;
}

const api = {
  // Takes the data. Returns a list of {id, kind, tab, title, thesis, choices} as JSON.
  load(text: string): string {
    entries = [];
    make_page(JSON.parse(text) as PageData).tabs.forEach((tab) => {
      tab.items.forEach((item) => {
        if (item.kind === 'figure' || item.kind === 'table') {
          entries.push({ tab: tab.id, item });
        }
      });
    });
    return JSON.stringify(
      entries.map(({ tab, item }) => ({
        id: item.id,
        kind: item.kind,
        tab,
        title: item.title,
        thesis: item.thesis ?? '',
        choices: item.kind === 'figure' ? (item.choices ?? []) : [],
      })),
    );
  },
  // If width or height is 0, the size of the figure itself is used.
  draw(id: string, theme: string, width: string, height: string, picks: string): string {
    const figure = find(id);
    if (figure.kind !== 'figure') {
      throw new Error(id + ' is a table');
    }
    const paper = get_paper_size(figure);
    const look = theme === 'dark' ? kDark : kLight;
    return draw_svg(figure, look, get_picks(figure, picks), Number(width) || paper.width, Number(height) || paper.height);
  },
  table(id: string, picks: string): string {
    const item = find(id);
    const table: DataTable = item.kind === 'figure' ? item.table(get_picks(item, picks)) : item.table;
    return to_csv(table);
  },
};

(globalThis as unknown as { armwright: typeof api }).armwright = api;
