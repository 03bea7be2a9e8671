// The view of tiles and of a card of grades.
import type { GradeLine, SummaryItem, Tile } from '../model';
import { make } from './dom';
import type { View } from './view';

function make_tile(tile: Tile): HTMLElement {
  return make(
    'div',
    { class: 'tile' },
    make('dt', {}, tile.label),
    make('dd', { class: 'tile-value ' + (tile.mark ?? '') }, tile.value),
    tile.detail === '' ? null : make('dd', { class: 'tile-detail' }, tile.detail),
  );
}

function make_line(line: GradeLine): HTMLElement {
  return make(
    'tr',
    { 'data-mark': line.mark },
    make('th', { scope: 'row' }, line.name),
    make('td', {}, make('span', { class: 'mark ' + line.mark }, line.state)),
    make('td', {}, line.value, line.meaning === '' ? null : make('span', { class: 'meaning' }, line.meaning)),
  );
}

export function make_summary_view(item: SummaryItem): View {
  const element = make(
    'section',
    { class: (item.lines.length > 0 ? 'card ' : '') + 'full summary', id: 'figure-' + item.id, 'data-figure': item.id },
    item.title === '' ? null : make('h3', {}, item.title),
    item.verdict === undefined ? null : make('p', { class: 'verdict ' + item.verdict.mark }, item.verdict.text),
    item.tiles.length === 0 ? null : make('dl', { class: 'tiles' }, ...item.tiles.map(make_tile)),
    item.lines.length === 0 ? null : make('table', { class: 'grades' }, make('tbody', {}, ...item.lines.map(make_line))),
    item.caption === undefined ? null : make('p', { class: 'caption' }, item.caption),
  );
  return { element, set_look() {}, update: () => false, settle() {}, dispose() {} };
}
