// A box that scrolls what is larger than it. At each edge at which something is cut, the box has a
// shadow, and a sentence below says where to scroll. A box that cuts at a line between two rows would
// look complete without them.
import { make } from './dom';

const kRounding_px = 1; // sizes are fractions of a pixel, and scroll positions may be rounded

// Returns a box with `content`, with its shadows and its sentence. While it is cut, the keyboard reaches the box, and assistive
// technology announces it as `label`.
export function make_cut_box(label: string, content: HTMLElement[]): HTMLElement {
  const box = make('div', { class: 'table-scroll' }, ...content);
  const make_shadow = (edge: string): HTMLElement => make('div', { class: `cut cut-${edge}`, 'aria-hidden': 'true' });
  const shadows = { left: make_shadow('left'), right: make_shadow('right'), bottom: make_shadow('bottom') };
  const hint = make('p', { class: 'cut-hint' });
  const frame = make('div', { class: 'cut-frame' }, box, ...Object.values(shadows), hint);

  function show_shadows(): void {
    const right = box.scrollWidth - box.clientWidth - box.scrollLeft;
    const bottom = box.scrollHeight - box.clientHeight - box.scrollTop;
    shadows.left.hidden = box.scrollLeft <= kRounding_px;
    shadows.right.hidden = right <= kRounding_px;
    shadows.bottom.hidden = bottom <= kRounding_px;
    // The shadows lie within the scroll bars.
    for (const shadow of Object.values(shadows)) {
      shadow.style.setProperty('--bar-right', `${box.offsetWidth - box.clientWidth}px`);
      shadow.style.setProperty('--bar-bottom', `${box.offsetHeight - box.clientHeight}px`);
      shadow.style.setProperty('--box-height', `${box.offsetHeight}px`);
    }
  }

  function update(): void {
    const wide = box.scrollWidth > box.clientWidth + kRounding_px;
    const high = box.scrollHeight > box.clientHeight + kRounding_px;
    hint.hidden = !wide && !high;
    hint.textContent = `Scroll ${[wide ? 'to the right' : '', high ? 'down' : ''].filter((way) => way !== '').join(' and ')} for the rest of the table.`;
    const attributes = { tabindex: '0', role: 'region', 'aria-label': label };
    for (const [name, value] of Object.entries(attributes)) {
      if (hint.hidden) {
        box.removeAttribute(name);
      } else {
        box.setAttribute(name, value);
      }
    }
    show_shadows();
  }

  box.addEventListener('scroll', show_shadows, { passive: true });
  const observer = new ResizeObserver(update);
  [box, ...content].forEach((element) => observer.observe(element));
  return frame;
}
