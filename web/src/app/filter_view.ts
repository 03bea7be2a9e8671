// The choice of the optimizers that a comparison's page shows. It applies to all figures and tables
// of all tabs, and it changes no rank and no test.
import { shorten } from '../charts/names';
import type { StudyData } from '../data';
import { get_ranks, kMostAtFirst, sort_by } from '../figures/study_parts';
import { make } from './dom';

export interface OptimizerFilter {
  text: string; // parts of names, or patterns with * and ?, with spaces or commas between them
  hidden: string[]; // families
  best: boolean; // only the best kMostAtFirst of those that match
}

export interface Shown {
  optimizers: number[]; // by index
  sentence: string;
}

// Returns the library of "nlopt:cobyla"; optimizers of armwright itself have none.
export function get_family(label: string): string {
  const end = label.indexOf(':');
  return end > 0 ? label.slice(0, end) : 'armwright';
}

function make_pattern(word: string): RegExp {
  const escaped = word
    .replace(/[.+^${}()|[\]\\]/g, '\\$&')
    .replace(/\*/g, '.*')
    .replace(/\?/g, '.');
  return new RegExp(/[*?]/.test(word) ? `^${escaped}$` : escaped, 'i');
}

// Applies the filter. If no optimizer matches, it is not applied.
export function choose_shown(data: StudyData, filter: OptimizerFilter): Shown {
  const all = data.optimizers.map((_, o) => o);
  const patterns = filter.text
    .split(/[\s,]+/)
    .filter((word) => word !== '')
    .map(make_pattern);
  const matches = (label: string) =>
    filter.hidden.indexOf(get_family(label)) < 0 && (patterns.length === 0 || patterns.some((pattern) => pattern.test(label)));
  const matching = all.filter((o) => matches(data.optimizers[o].label));
  const none = matching.length === 0;
  const candidates = none ? all : matching;
  const ranks = get_ranks(data);
  const best = sort_by(candidates, (o) => ranks[o] ?? Infinity).slice(0, kMostAtFirst);
  const optimizers = filter.best ? all.filter((o) => best.indexOf(o) >= 0) : candidates;
  const rest = optimizers.length < candidates.length;
  const sentence =
    `${optimizers.length} of ${all.length} optimizers are shown` +
    (none ? ', because no name matches' : '') +
    (!none && matching.length < all.length && rest ? `: the best ${kMostAtFirst} of ${matching.length} that match` : '') +
    (matching.length === all.length && rest ? `: the best ${kMostAtFirst}` : '');
  return { optimizers, sentence: sentence + '.' };
}

export interface FilterView {
  element: HTMLElement;
  // Shows the state of the filter for these data, and returns the optimizers to show.
  apply(data: StudyData): number[];
}

export function make_filter_view(on_change: () => void): FilterView {
  const filter: OptimizerFilter = { text: '', hidden: [], best: true };
  const sentence = make('span', { role: 'status' });
  const text = make('input', { type: 'search', placeholder: 'cma, nlopt:*', spellcheck: 'false', autocomplete: 'off' });
  const families = make('fieldset', {}, make('legend', {}, 'Families'));
  const best = make('input', { type: 'checkbox' });
  const best_label = make('label', {}, best, `only the best ${kMostAtFirst} of these`);
  best.checked = filter.best;
  let listed = ''; // the families with boxes
  text.addEventListener('input', () => {
    filter.text = text.value;
    on_change();
  });
  best.addEventListener('change', () => {
    filter.best = best.checked;
    on_change();
  });

  function list_families(data: StudyData): void {
    const all = data.optimizers.map((one) => get_family(one.label));
    const distinct = all.filter((family, i) => all.indexOf(family) === i).sort();
    families.hidden = distinct.length < 2;
    if (listed === distinct.join(' ')) {
      return;
    }
    listed = distinct.join(' ');
    families.replaceChildren(
      families.firstChild as Node,
      ...distinct.map((family) => {
        const box = make('input', { type: 'checkbox' });
        box.checked = filter.hidden.indexOf(family) < 0;
        box.addEventListener('change', () => {
          filter.hidden = filter.hidden.filter((one) => one !== family).concat(box.checked ? [] : [family]);
          on_change();
        });
        return make('label', {}, box, `${shorten(family, 24)} (${all.filter((one) => one === family).length})`);
      }),
    );
  }

  return {
    element: make(
      'details',
      { class: 'filter' },
      make('summary', {}, sentence),
      make('label', {}, 'Names ', text),
      families,
      best_label,
      make(
        'p',
        { class: 'caption' },
        'The choice applies to all figures and tables of this page. It changes no rank and no test: they compare all optimizers.',
      ),
    ),
    apply(data) {
      list_families(data);
      best_label.hidden = data.optimizers.length <= kMostAtFirst;
      const shown = choose_shown(data, filter);
      sentence.textContent = shown.sentence;
      return shown.optimizers;
    },
  };
}
