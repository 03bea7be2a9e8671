// A line over each panel of a chart at one place of its abscissa, with the values of the curves
// there.
import type { Reading } from '../charts/zoom';
import { format_number } from '../numbers';
import { make } from './dom';

export interface Crossing {
  panel: { x: number; y: number; width: number; height: number }; // pixels in the frame
  x_px: number;
  at: number;
  x_name: string;
  y_name: string;
  readings: Reading[];
}

const kGap_px = 10; // between the line and the values
const kMostRows = 14;

function make_box(crossing: Crossing): HTMLElement {
  const { readings } = crossing;
  const rows = readings.slice(0, kMostRows).map((one) => {
    const swatch = make('span', { class: 'swatch' });
    swatch.style.background = one.color;
    return make('tr', {}, make('td', {}, swatch, one.name), make('td', { class: 'number' }, format_number(one.value)));
  });
  const more = readings.length - rows.length;
  return make(
    'div',
    { class: 'readings' },
    make(
      'table',
      {},
      make('tr', {}, make('td', {}, crossing.x_name), make('td', { class: 'number' }, format_number(crossing.at, 5))),
      ...rows,
    ),
    crossing.y_name === '' ? null : make('div', {}, crossing.y_name),
    more > 0 ? make('div', {}, `and ${more} more`) : null,
  );
}

export class CrossHair {
  readonly element = make('div', { class: 'cross-hair', 'aria-hidden': 'true' });

  show(crossings: Crossing[]): void {
    this.element.replaceChildren();
    for (const crossing of crossings) {
      const { panel, x_px } = crossing;
      const line = make('div', { class: 'cross-line' });
      line.style.transform = `translate(${x_px}px, ${panel.y}px)`;
      line.style.height = `${panel.height}px`;
      this.element.append(line);
      if (crossing.readings.length === 0) {
        continue;
      }
      const box = make_box(crossing);
      this.element.append(box);
      // On the side of the line with more space, and within the frame.
      const { clientWidth, clientHeight } = this.element;
      const is_left = x_px > panel.x + panel.width / 2;
      const left = is_left ? x_px - kGap_px - box.offsetWidth : x_px + kGap_px;
      const top = Math.min(panel.y + 4, clientHeight - box.offsetHeight);
      const inside = Math.max(0, Math.min(left, clientWidth - box.offsetWidth));
      box.style.transform = `translate(${inside}px, ${Math.max(0, top)}px)`;
    }
  }
}
