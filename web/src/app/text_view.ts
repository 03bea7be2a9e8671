// The view of a text: paragraphs under a title, a headline, or a text that is folded away.
import type { TextItem } from '../model';
import { make } from './dom';
import { make_text } from './term_view';
import type { View } from './view';

const make_paragraphs = (item: TextItem): HTMLElement[] => item.paragraphs.map((text) => make('p', {}, ...make_text(text)));

export function make_text_view(first: TextItem): View {
  let texts = JSON.stringify(first.paragraphs);
  const title = make('h3', {}, first.title);
  const folded = first.style === 'folded';
  const body = make('div', { class: first.style === 'headline' ? 'headline' : '' }, ...make_paragraphs(first));
  const details = folded ? make('details', {}, make('summary', {}, title), body) : null;
  const attributes = { class: 'card full', id: 'figure-' + first.id, 'data-figure': first.id };
  return {
    element: details === null ? make('section', attributes, title, body) : make('section', attributes, details),
    set_look() {},
    // A text that the reader has opened stays open.
    update(item) {
      if (item.kind !== 'text' || item.style !== first.style) {
        return false;
      }
      title.textContent = item.title;
      // The same paragraphs stay, so that the keyboard's focus stays on a term.
      if (texts !== JSON.stringify(item.paragraphs)) {
        texts = JSON.stringify(item.paragraphs);
        body.replaceChildren(...make_paragraphs(item));
      }
      return true;
    },
    // Paper shows everything.
    settle() {
      if (details !== null) {
        details.open = true;
      }
    },
    dispose() {},
  };
}
