import type { Provenance } from '../model';
import { make, make_button } from './dom';
import { download } from './download';

// Returns a box that shows where a point or a row comes from, its file, and the command that makes it
// again.
export function make_provenance({ note, command, file }: Provenance, on_close: () => void): HTMLElement {
  const box = make('div', { class: 'provenance' });
  if (note) {
    box.append(make('p', {}, note));
  }
  if (file) {
    box.append(
      make_button('Save ' + file.name, () => download(file.name, 'application/toml', file.text), {
        class: 'save-design',
        title: 'The design as a file, for the command below',
      }),
    );
  }
  if (command) {
    const text = make('code', {}, command);
    const copy = make_button('Copy', () => {
      const range = document.createRange();
      range.selectNodeContents(text);
      getSelection()?.removeAllRanges();
      getSelection()?.addRange(range);
      // A page opened from disk may have no access to the clipboard. The text is selected in any
      // case.
      navigator.clipboard?.writeText(command).then(
        () => (copy.textContent = 'Copied'),
        () => (copy.textContent = 'Selected: press Ctrl+C'),
      );
    });
    box.append(make('div', { class: 'command' }, text, copy));
  }
  box.append(make_button('×', on_close, { class: 'close', 'aria-label': 'Close' }));
  return box;
}
