// Terms in the texts of a page. The pointer, the keyboard's focus and a tap show what a term means;
// Escape, or a step away, hides it. Assistive technology reads the meaning as the term's description.
import { make, make_button } from './dom';
import { split_terms, type Term } from './terms';

const kLinger_ms = 200; // so that the pointer can move from the term to its meaning
const kGap_px = 6;

let tips: Map<string, HTMLElement> | null = null; // by id; null before the first term
let shown: { trigger: HTMLElement; tip: HTMLElement } | null = null;
let closing = 0; // timer

function place(): void {
  if (shown === null) {
    return;
  }
  const { trigger, tip } = shown;
  const at = trigger.getBoundingClientRect();
  const { width, height } = tip.getBoundingClientRect();
  const page = document.documentElement;
  const below = at.bottom + kGap_px + height <= page.clientHeight || at.top < height + kGap_px;
  tip.style.left = `${Math.max(kGap_px, Math.min(at.left, page.clientWidth - width - kGap_px))}px`;
  tip.style.top = `${below ? at.bottom + kGap_px : at.top - kGap_px - height}px`;
}

function hide(): void {
  clearTimeout(closing);
  shown?.tip.hidePopover();
  shown = null;
}

function show(trigger: HTMLElement): void {
  const tip = tips?.get(trigger.getAttribute('aria-describedby') ?? '');
  clearTimeout(closing);
  if (tip === undefined || shown?.trigger === trigger) {
    return;
  }
  hide();
  shown = { trigger, tip };
  tip.showPopover(); // above everything, a dialog included
  place();
}

const find_trigger = (event: Event): HTMLElement | null =>
  event.target instanceof Element ? event.target.closest<HTMLElement>('[data-term]') : null;

function listen(): void {
  for (const kind of ['focusin', 'pointerover', 'click']) {
    document.addEventListener(kind, (event) => {
      const trigger = find_trigger(event);
      if (trigger !== null) {
        show(trigger);
      } else if (event.target instanceof Node && shown?.tip.contains(event.target)) {
        clearTimeout(closing);
      } else if (kind === 'click') {
        hide();
      }
    });
  }
  document.addEventListener('focusout', (event) => {
    if (shown !== null && find_trigger(event) === shown.trigger) {
      hide();
    }
  });
  document.addEventListener('pointerout', (event) => {
    if (shown !== null && event.pointerType === 'mouse' && document.activeElement !== shown.trigger) {
      clearTimeout(closing);
      closing = window.setTimeout(hide, kLinger_ms);
    }
  });
  // Before a dialog sees the key: the first Escape hides the meaning, the next one closes the dialog.
  document.addEventListener(
    'keydown',
    (event) => {
      if (event.key === 'Escape' && shown !== null) {
        event.preventDefault();
        event.stopPropagation();
        hide();
      }
    },
    true,
  );
  window.addEventListener('scroll', place, { capture: true, passive: true });
  window.addEventListener('resize', place, { passive: true });
}

// Lets `trigger` show the term's meaning.
export function explain(trigger: HTMLElement, term: Term): void {
  if (tips === null) {
    tips = new Map();
    listen();
  }
  const id = 'term-' + term.name.toLowerCase().replace(/[^a-z0-9]+/g, '-');
  if (!tips.has(id)) {
    const tip = make(
      'div',
      { id, role: 'tooltip', popover: 'manual', class: 'term-tip' },
      make('strong', {}, term.name),
      ' ',
      term.meaning,
    );
    tips.set(id, tip);
    document.body.append(tip);
  }
  trigger.setAttribute('data-term', term.name);
  trigger.setAttribute('aria-describedby', id);
}

// Returns the text with its terms as buttons that explain themselves.
export function make_text(text: string): Node[] {
  return split_terms(text).map((part) => {
    if (part.term === undefined) {
      return document.createTextNode(part.text);
    }
    const button = make_button(part.text, () => {}, { class: 'term' });
    explain(button, part.term);
    return button;
  });
}
