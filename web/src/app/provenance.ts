import { make, make_button } from './dom';

// Returns a box that shows where a point or a row comes from, and the command that makes it again.
export function make_provenance(note: string | undefined, command: string | undefined, on_close: () => void): HTMLElement {
  const box = make('div', { class: 'provenance' });
  if (note) {
    box.append(make('p', {}, note));
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
