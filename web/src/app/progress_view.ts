// The view of the progress: a bar with words below it, which is hidden once there is nothing left to do.
import type { PageBase } from '../data';
import { describe_progress } from '../figures/watched';
import { make } from './dom';

export interface ProgressView {
  element: HTMLElement;
  show(data: PageBase): void;
}

export function make_progress_view(): ProgressView {
  const filled = make('div', { class: 'progress-filled' });
  const bar = make('div', { class: 'progress-bar', role: 'progressbar', 'aria-label': 'Progress', 'aria-valuemin': '0' }, filled);
  const words = make('ul', { class: 'progress-words' });
  const element = make('div', { class: 'progress' }, bar, words);
  return {
    element,
    show(data) {
      const { progress } = data;
      element.hidden = progress === null;
      if (progress === null) {
        return;
      }
      const texts = describe_progress(data);
      bar.setAttribute('aria-valuemax', String(progress.total));
      bar.setAttribute('aria-valuenow', String(progress.done));
      bar.setAttribute('aria-valuetext', texts.join('; '));
      filled.style.width = (progress.total > 0 ? Math.min(100, (100 * progress.done) / progress.total) : 0) + '%';
      words.replaceChildren(...texts.map((text) => make('li', {}, text)));
    },
  };
}
